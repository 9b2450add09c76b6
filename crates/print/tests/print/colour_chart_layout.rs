//! Where everything is on a colour chart.

use scaleproof_print::colour_chart::layout::{CELL_MM, ChartCell, ChartKind, ChartLayout, FAMILY, MORE_BLACKS};
use std::collections::BTreeSet;

#[test]
fn every_colour_of_the_cube_has_one_patch_and_whites_are_everywhere() {
    for kind in ChartKind::ALL {
        let chart = ChartLayout::new(kind);
        let cube = kind.levels().len().pow(3);
        let colours: BTreeSet<_> = chart.patches.iter().map(|p| p.asked_rgb).collect();
        let blacks = chart.patches.iter().filter(|p| p.asked_rgb == [0; 3]).count();
        let greys = chart.patches.len() - cube - MORE_BLACKS;
        assert_eq!((colours.len(), blacks), (cube + greys, 1 + MORE_BLACKS), "{kind:?}");
        let cells: BTreeSet<_> = chart
            .whites
            .iter()
            .chain(chart.patches.iter().map(|p| &p.cell))
            .collect();
        let (columns, rows) = kind.grid();
        assert_eq!(cells.len(), columns * rows - 5 * 4, "each cell once, tags apart");
        // From every patch a white is near.
        for patch in &chart.patches {
            let [x, y] = patch.cell.centre_mm();
            let far = |c: &ChartCell| (c.centre_mm()[0] - x).hypot(c.centre_mm()[1] - y);
            let nearest = chart.whites.iter().map(far).fold(f64::INFINITY, f64::min);
            assert!(nearest < 3.2 * CELL_MM, "{kind:?} {patch:?}: {nearest}");
        }
    }
}

#[test]
fn no_two_charts_share_a_tag() {
    let ids: BTreeSet<_> = ChartKind::ALL.iter().flat_map(|kind| kind.tag_ids()).collect();
    assert_eq!(ids.len(), 15);
    assert!(ids.iter().all(|id| *id < FAMILY.count()));
}
