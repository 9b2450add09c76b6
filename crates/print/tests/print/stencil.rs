//! Stencils that hold together.

use proptest::prelude::*;
use scaleproof_print::paint::plane::{self, Area, Bounds, PlaneOutline, PlanePoint, units};
use scaleproof_print::paint::{Rules, Stencil, stencil};

const RULES: Rules = Rules {
    min_feature_mm: 1.5,
    rim_mm: 10.0,
};

fn cell(column: i32, row: i32, mm: f64) -> PlaneOutline {
    let edge = |i: i32| units(f64::from(i) * mm);
    Bounds {
        left: edge(column),
        bottom: edge(row),
        right: edge(column + 1),
        top: edge(row + 1),
    }
    .outline()
}

/// A stencil of the cells of a square that `paint` says, all of them `mm` wide.
fn of_cells(side: i32, mm: f64, paint: impl Fn(i32, i32) -> bool) -> Stencil {
    let all = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
    let cells: Vec<PlaneOutline> = all
        .filter(|(c, r)| paint(*c, *r))
        .map(|(c, r)| cell(c, r, mm))
        .collect();
    let region = Bounds {
        left: 0,
        bottom: 0,
        right: units(f64::from(side) * mm),
        top: units(f64::from(side) * mm),
    };
    stencil(&cells, &[region.outline()], RULES).unwrap()
}

fn material(made: &Stencil) -> Area {
    Area::of(&[made.outer.outline()]).without(&made.openings)
}

fn assert_sound(made: &Stencil) {
    let half = units(0.5 * RULES.min_feature_mm) - 2;
    let material = material(made);
    assert_eq!(material.pieces.len(), 1);
    let core = material.shrunk(half);
    assert_eq!(core.pieces.len(), 1, "cut through its necks");
    assert_eq!(
        core.pieces[0].len(),
        material.pieces[0].len(),
        "a neck hangs beside the others"
    );
    assert!(
        material.without(&core.grown(half)).shrunk(20).is_empty(),
        "something is thin"
    );
}

#[test]
fn an_island_gets_one_straight_bridge() {
    let made = of_cells(3, 6.0, |c, r| (c, r) != (1, 1));
    assert_sound(&made);
    // From the island straight to the rim: 6 mm of 1.5 mm, and the spare.
    let bridged = made.bridges.mm2();
    assert!((9.0..9.1).contains(&bridged), "{bridged}");
}

#[test]
fn every_corner_of_a_checkerboard_is_joined() {
    let made = of_cells(6, 6.0, |c, r| (c + r) % 2 == 0);
    assert_sound(&made);
    assert_eq!(made.openings.pieces.len(), 18);
    // 25 corners, each two right triangles with legs of 1.5 mm.
    let bridged = made.bridges.mm2();
    assert!((bridged - 25.0 * 1.5 * 1.5).abs() < 0.5, "{bridged}");
}

#[test]
fn the_smallest_cells_leave_openings() {
    let made = of_cells(6, 4.5, |c, r| (c + r) % 2 == 0);
    assert_sound(&made);
    assert!(made.openings.mm2() > 0.5 * 18.0 * 4.5 * 4.5);
}

#[test]
fn outlines_may_be_slanted_and_regions_have_holes() {
    let ngon = |n: u32, mm: f64| -> PlaneOutline {
        let corner = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
        (0..n)
            .map(|i| PlanePoint::new(units(mm * corner(i).cos()), units(mm * corner(i).sin())))
            .collect()
    };
    let hole: PlaneOutline = ngon(7, 12.0).into_iter().rev().collect();
    let made = stencil(&[ngon(5, 60.0)], &[ngon(11, 50.0), hole], RULES).unwrap();
    assert_sound(&made);
    assert!(made.openings.mm2() > 4000.0 && made.bridges.mm2() > 40.0);
}

proptest! {
    #[test]
    fn any_cells_make_one_sound_piece(bits in prop::collection::vec(any::<bool>(), 64), mm in 4.5..9.0_f64) {
        let made = of_cells(8, mm, |c, r| bits[(r * 8 + c) as usize]);
        assert_sound(&made);
        let cells = bits.iter().filter(|b| **b).count() as f64;
        let asked = cells * mm * mm;
        // Every edge of a cell is rounded, by half a unit at most.
        let rounding = cells * 4.0 * mm * 0.5 * plane::mm(1);
        prop_assert!((made.openings.mm2() + made.bridges.mm2() - asked).abs() < rounding + 0.01);
        prop_assert!(made.bridges.mm2() < 0.6 * asked + 0.01);
    }
}
