//! Proposal of the materials that are a mesh's paint, by their names and by how much of them is seen.

const PAINT: [&str; 7] = ["paint", "body", "lack", "karosserie", "livery", "coat", "exterior"];
/// Words in the names of other materials.
const OTHER: [&str; 33] = [
    "glass",
    "glas",
    "window",
    "windscreen",
    "windshield",
    "tyre",
    "tire",
    "wheel",
    "light",
    "lamp",
    "chrome",
    "interior",
    "seat",
    "rubber",
    "mirror",
    "plate",
    "grill",
    "engine",
    "brake",
    "steer",
    "shadow",
    "ground",
    "plastic",
    "trim",
    "logo",
    "badge",
    "exhaust",
    "leather",
    "black",
    "underbody",
    "underside",
    "chassis",
    "rims",
];
/// Least share of the visible surface that a material which is called paint has.
const SEEN: f64 = 0.05;
/// Share of the largest material: where the second largest has less, the largest is the paint.
const CLEARLY_LESS: f64 = 0.6;

/// Several materials may be the paint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("which of its materials are the paint cannot be told: it has {known}")]
pub struct PaintDoubt {
    known: String,
}

/// Returns the materials that are the paint, by name, with the reason as a clause; no name stands for all of the mesh. `seen` is each material's
/// share of what is seen of the model from all around.
///
/// # Errors
/// Materials of which two have almost equal claims.
pub fn propose_paint(names: &[String], seen: &[f64]) -> Result<(Vec<String>, &'static str), PaintDoubt> {
    let mut materials: Vec<(&str, f64)> = Vec::new();
    for (name, share) in names.iter().zip(seen) {
        match materials.iter_mut().find(|(known, _)| known == name) {
            Some((_, sum)) => *sum += share,
            None => materials.push((name, *share)),
        }
    }
    materials.sort_by(|a, b| b.1.total_cmp(&a.1));
    if let [_] = materials[..] {
        return Ok((Vec::new(), "all of the mesh, which has one material"));
    }
    let owned = |chosen: &[&(&str, f64)]| chosen.iter().map(|(name, _)| (*name).to_owned()).collect();
    let has = |name: &str, words: &[&str]| words.iter().any(|word| name.to_lowercase().contains(word));
    let is_rim = |name: &str| {
        name.to_lowercase()
            .split(|c: char| !c.is_alphabetic())
            .any(|part| part == "rim")
    };
    let is_other = |name: &str| (has(name, &OTHER) || is_rim(name)) && !has(name, &PAINT[..1]);
    let named: Vec<_> = materials
        .iter()
        .filter(|(name, share)| has(name, &PAINT) && !is_other(name) && *share >= SEEN)
        .collect();
    if !named.is_empty() {
        return Ok((owned(&named), "by its name"));
    }
    let rest: Vec<_> = materials.iter().filter(|(name, _)| !is_other(name)).collect();
    match rest[..] {
        [first, ..] if first.1 >= SEEN && rest.get(1).is_none_or(|second| second.1 < CLEARLY_LESS * first.1) => {
            Ok((owned(&[first]), "as most of what is seen has it"))
        }
        _ => {
            // Materials that are hardly seen are not listed.
            let known = materials.iter().filter(|(_, share)| *share >= 0.01);
            let known: Vec<_> = known
                .map(|(name, share)| format!("'{name}' ({:.0} % of what is seen)", 100.0 * share))
                .collect();
            Err(PaintDoubt {
                known: known.join(", "),
            })
        }
    }
}
