//! Coverage plot: the camera's positions seen from above, the model's front up, with the fate of each frame.

use crate::choose::{Refusal, SelectionCriteria, count_refusals};
use crate::keep::SavedFrame;
use crate::tracking::FrameResult;
use scaleproof_plot::Anchor::Middle;
use scaleproof_plot::{BLACK, Colour, Drawing, Explained, FAINT, Mark, NOTE, WHITE, colour, figure};
use scaleproof_pose::scene::Viewpoint;

const RADIUS: f64 = 150.0;
/// Distance at which the farthest frame is drawn, as a share of the radius.
const FAR: f64 = 0.97;
/// Maximum number of dots.
const MOST_DOTS: usize = 1500;
const FIT: Colour = Colour(0x9fb4c7);

/// Draws the plot as SVG.
pub fn svg(title: &str, criteria: &SelectionCriteria, looks: &[FrameResult], kept: &[SavedFrame]) -> String {
    let views: Vec<(&Viewpoint, Option<Refusal>)> = looks
        .iter()
        .filter_map(|look| Some((&look.shows.as_ref().ok()?.viewpoint, criteria.refusal(look))))
        .collect();
    let counts = count_refusals(criteria, looks);
    let fit = looks.len() - counts.values().sum::<usize>();
    let mut legend = vec![(BLACK, format!("chosen {}", kept.len())), (FIT, format!("fit {fit}"))];
    let drawn = counts
        .iter()
        .filter(|(refusal, _)| !matches!(refusal, Refusal::NoTags | Refusal::Unsure | Refusal::Repeated));
    legend.extend(drawn.map(|(refusal, count)| (hue(*refusal), format!("{} {count}", refusal.name()))));
    let unplaced = [Refusal::NoTags, Refusal::Unsure].map(|refusal| counts.get(&refusal).copied().unwrap_or(0));
    let notes = vec![
        "Where the camera stood, from above, the model's front up; spokes: edges of the bins.".to_owned(),
        format!(
            "{} frames looked at; not drawn as no pose is known: {} without tags, {} without a sure pose.",
            looks.len(),
            unplaced[0],
            unplaced[1]
        ),
    ];
    let drawing = Drawing {
        area: [-190.0, -175.0, 380.0, 350.0],
        label: title.to_owned(),
        marks: marks(criteria, &views, kept),
    };
    figure(title, &Explained { legend, notes }, 1, vec![("", drawing)]).svg()
}

fn hue(refusal: Refusal) -> Colour {
    let place = Refusal::ALL.iter().position(|other| *other == refusal).unwrap_or(0);
    // After the blues, which are near to that of fit frames.
    match place {
        0..=3 => colour(1),
        4 | 5 => colour(8),
        6 => colour(2),
        7 => colour(4),
        _ => colour(3),
    }
}

fn marks(criteria: &SelectionCriteria, views: &[(&Viewpoint, Option<Refusal>)], kept: &[SavedFrame]) -> Vec<Mark> {
    let far_mm = views
        .iter()
        .map(|(v, _)| ground_mm(v))
        .chain(criteria.bins.distance_mm.iter().copied())
        .fold(1.0, f64::max);
    let at = |v: &Viewpoint| place(v.azimuth_deg, FAR * ground_mm(v) / far_mm);
    let step = criteria.bins.azimuth_deg;
    let centres = criteria.bins.azimuth_centres();
    let every = views.len().div_ceil(MOST_DOTS).max(1);
    let names = [("front", 0.0), ("left", 90.0), ("rear", 180.0), ("right", 270.0)];
    let mut marks = vec![Mark::circle([0.0; 2], RADIUS).outlined(FAINT, 1.0)];
    let edges = centres.iter().map(|centre| place(centre + step / 2.0, 1.0));
    marks.extend(edges.map(|edge| Mark::line([0.0; 2], edge, FAINT)));
    for (name, azimuth) in names {
        let [x, y] = place(azimuth, 1.08);
        marks.push(Mark::text([x, y + 4.0], 11.0, Middle, NOTE, name));
    }
    marks.push(Mark::polygon([[0.0, -12.0], [7.0, 8.0], [-7.0, 8.0]]).filled(NOTE));
    let seen = views.iter().step_by(every);
    marks.extend(seen.map(|(v, refusal)| Mark::circle(at(v), 2.0).filled(refusal.map_or(FIT, hue))));
    let chosen = kept.iter().map(|one| Mark::circle(at(&one.viewpoint), 4.5));
    marks.extend(chosen.map(|dot| dot.filled(BLACK).outlined(WHITE, 1.0)));
    marks
}

/// Returns the distance of the camera from the middle of the model, on the ground, mm.
fn ground_mm(v: &Viewpoint) -> f64 {
    v.distance_mm * v.pitch_deg.to_radians().cos()
}

/// Returns the point of an azimuth at a share of the radius: front up, counter-clockwise seen from above, so that the model's left side is on the left.
fn place(azimuth_deg: f64, share: f64) -> [f64; 2] {
    let a = azimuth_deg.to_radians();
    [-RADIUS * share * a.sin(), -RADIUS * share * a.cos()]
}
