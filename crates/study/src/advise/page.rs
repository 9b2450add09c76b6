//! The advice as one self-contained page; no script, no link to anywhere.

use maud::{Markup, PreEscaped, html};

use super::figures::FigureAdvice;
use super::method::Question;
use super::result::{Advice, CameraVerdict, Choice, PoseAdvice, Verdict};
use super::table::{camera, findings, in_words, interval, number, unreadable};
use crate::chart::milliseconds;
use scaleproof_core::spelling::{count, digits};
use scaleproof_plot::{Cloud, Dot, PlotAxis, Scale, plain_page, scatter};
use scaleproof_score::report::briefly;

pub fn page(all: &Advice) -> String {
    let advice = &all.poses;
    let lead = html! {
        (capital(&unreadable(all))) (count(advice.photos, "photo")) ", " (advice.located) " of them located; a tag could be left out and predicted in " (advice.held_out_photos) "."
    };
    let content = html! {
        @if let Some(check) = advice.camera_check.as_ref().filter(|check| check.verdict != CameraVerdict::Fits) { p.banner { (capital(&camera(check))) "." } }
        @match &advice.abstention {
            Some(why) => { p.banner { "No advice on poses: " (why) "." } }
            None => {
                section {
                    div.figures {
                        @for question in Question::ALL {
                            div { span { (question.title()) } b { (advice.advised(question).map_or("cannot tell", |choice| &choice.name)) } }
                        }
                    }
                }
                @for question in Question::ALL { section { h2 { (capital(question.title())) } (section(advice, question)) } }
                @if let Some(check) = advice.camera_check.as_ref().filter(|check| check.verdict == CameraVerdict::Fits) { section { h2 { "Camera file" } p { (capital(&camera(check))) "." } } }
                p.note { (HOW) }
            }
        }
        @if let Some(figures) = &all.figures { section { h2 { "Figures" } (of_figures(figures)) } }
    };
    plain_page(
        &format!("What {} needs", all.session),
        &lead,
        &content,
        "Times are of one core of this machine.",
    )
}

const HOW: &str = "Held out: a tag is left out, the pose is made of the others, and its corners are predicted; the error is the root mean square of the four, as an angle, and its mean over tags and photos. \
    “More than the best”: the difference from the most accurate way that locates as many photos, on the same photos, with its 95 % interval (2,000 resamples of the photos). Advised is the smallest way that \
    loses no photo, moves none to another bin and none by more than five standard deviations of its usual pose, is not shown worse, whose error is within a twentieth of the smallest, and, of tags, whose poses are at most a twentieth less certain; of solvers, whose time is little beside the search, the usual one where it is such a way. PoseShift: how far the viewpoints are from the usual ones, middle photo.";

fn capital(title: &str) -> String {
    let mut letters = title.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// Renders the drops by each definition of AP, and by the box.
fn of_figures(figures: &FigureAdvice) -> Markup {
    html! {
        @for sentence in findings(figures) { p { (sentence) "." } }
        div.scroll {
            table {
                thead { tr { th { "detector" } @for head in ["texture", "definition of AP", "truth boxes", "AP@0.5", "drop, 95 %", "", "moves the drop by, 95 %"] { th { (head) } } } }
                tbody {
                    @for row in &figures.rows {
                        tr {
                            td { (row.detector) } td { (row.variant) } td { (row.definition) } td { (row.envelope) }
                            td { (digits(row.base_ap50, 3)) " → " (digits(row.ap50, 3)) }
                            td { (digits(row.drop, 3)) (interval(row.drop_95, 3)) }
                            td { (briefly(row.effect)) }
                            td { (number(row.moved_by, 3, "")) (interval(row.moved_by_95, 3)) }
                        }
                    }
                }
            }
        }
    }
}

fn section(advice: &PoseAdvice, question: Question) -> Markup {
    let own: Vec<&Choice> = advice.choices_for(question).collect();
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "way" } th { "verdict" }
                        @for head in ["ms", "located", "held out", "more than the best", "direction moved", "distance moved"] { th { (head) } }
                    }
                }
                tbody {
                    @for choice in &own {
                        tr.chosen[choice.verdict == Verdict::Advised] {
                            td { (choice.name) @if choice.is_usual { " (usual)" } }
                            td.text { (in_words(choice)) }
                            td { (digits(choice.ms, 2)) }
                            td { (choice.located) }
                            td { (number(choice.held_out_deg, 4, "°")) }
                            td { (number(choice.worse_by_deg, 4, "°")) (interval(choice.worse_by_95, 4)) }
                            td { (number(choice.moved_deg, 4, "°")) }
                            td { (number(choice.moved_mm, 2, " mm")) }
                        }
                    }
                }
            }
        }
        div.chart { (PreEscaped(chart(question, &own))) }
    }
}

fn chart(question: Question, own: &[&Choice]) -> String {
    let most_located = own.iter().map(|choice| choice.located).max().unwrap_or(1).max(1);
    let dots = own.iter().enumerate().filter_map(|(i, choice)| {
        Some(Dot {
            x: choice.ms,
            y: choice.held_out_deg?,
            share: choice.located as f64 / most_located as f64,
            series: i,
            shape: 0,
            name: Some(choice.name.clone()),
            is_ringed: choice.verdict == Verdict::Advised,
        })
    });
    scatter(&Cloud {
        title: format!("Held-out error against time: {}", question.title()),
        note: "filled share of a mark: share of the photos that got a pose; lower left is better".to_owned(),
        x: milliseconds(own.iter().map(|choice| choice.ms)),
        y: PlotAxis::around(
            "held-out error, °",
            Scale::Log,
            own.iter().filter_map(|choice| choice.held_out_deg),
        ),
        colours: own.iter().map(|choice| choice.name.clone()).collect(),
        shapes: Vec::new(),
        ringed: "advised".to_owned(),
        groups: vec![(String::new(), dots.collect())],
    })
    .svg()
}
