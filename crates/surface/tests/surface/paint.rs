//! Which materials are proposed as the paint. A new case is a new line of the table.

use scaleproof_surface::mesh::propose_paint;

/// The materials with their share of what is seen, and the paint; `None` where it is to be asked for.
type Case = (&'static [(&'static str, f64)], Option<&'static [&'static str]>);

const CASES: &[Case] = &[
    // One material is all of the mesh, whatever its name.
    (&[("glass", 1.0)], Some(&[])),
    // Names, in whatever case; several of one kind belong together.
    (
        &[("rest", 0.5), ("CarPaint_red", 0.3), ("carpaint_white", 0.2)],
        Some(&["CarPaint_red", "carpaint_white"]),
    ),
    (&[("Karosserie", 0.3), ("Glas", 0.7)], Some(&["Karosserie"])),
    (&[("underbody", 0.5), ("body", 0.5)], Some(&["body"])),
    (&[("black_paint", 0.6), ("rest", 0.4)], Some(&["black_paint"])),
    // A name that is hardly seen says nothing.
    (
        &[("paint_logo", 0.01), ("Material.001", 0.8), ("Material.002", 0.19)],
        Some(&["Material.001"]),
    ),
    // Without names, what is clearly seen most; windows and wheels are left out first.
    (&[("a", 0.6), ("b", 0.3), ("c", 0.1)], Some(&["a"])),
    (&[("Window", 0.5), ("a", 0.4), ("rim.front", 0.1)], Some(&["a"])),
    (&[("a", 0.5), ("b", 0.45), ("c", 0.05)], None),
    (&[("window", 0.5), ("wheel", 0.5)], None),
    // Materials of one name are one.
    (&[("a", 0.25), ("b", 0.3), ("a", 0.45)], Some(&["a"])),
];

#[test]
fn paint_is_proposed_by_name_then_by_what_is_seen_or_asked_for() {
    for (materials, paint) in CASES {
        let names: Vec<String> = materials.iter().map(|(name, _)| (*name).to_owned()).collect();
        let seen: Vec<f64> = materials.iter().map(|(_, share)| *share).collect();
        let found = propose_paint(&names, &seen).ok().map(|(names, _)| names);
        assert_eq!(
            found,
            paint.map(|names| names.iter().map(|name| (*name).to_owned()).collect()),
            "{materials:?}"
        );
    }
}
