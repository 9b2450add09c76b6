//! A plain page of its own: no script, no link to anywhere.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// A page without a link to anywhere: its title, what it looks like, and what is in it.
pub fn html_page(title: &str, style: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " · scaleproof" }
                style { (PreEscaped(style)) }
            }
            body { (body) }
        }
    }
    .into_string()
}

/// The page as an HTML file. `lead` stands below the title; `foot` behind the program's version.
pub fn plain_page(title: &str, lead: &Markup, content: &Markup, foot: &str) -> String {
    let body = html! {
        header { h1 { (title) } p.lead { (lead) } }
        main { (content) }
        footer { p.note { "scaleproof " (env!("CARGO_PKG_VERSION")) ". " (foot) } }
    };
    html_page(title, STYLE, &body)
}
