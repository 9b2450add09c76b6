//! A plain page of its own: no script, no link to anywhere.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// The page as an HTML file. `lead` stands below the title; `foot` behind the program's version.
pub(crate) fn plain_page(title: &str, lead: &Markup, content: &Markup, foot: &str) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " · scaleproof" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { h1 { (title) } p.lead { (lead) } }
                main { (content) }
                footer { p.note { "scaleproof " (env!("CARGO_PKG_VERSION")) ". " (foot) } }
            }
        }
    }
    .into_string()
}
