//! Plain HTML page, without scripts and external links.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// Returns a page without external links: its title, its style sheet, and its body.
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

/// Returns the page as an HTML file. `lead` follows the title; `foot` the program's version.
pub fn plain_page(title: &str, lead: &Markup, content: &Markup, foot: &str) -> String {
    let body = html! {
        header { h1 { (title) } p.lead { (lead) } }
        main { (content) }
        footer { p.note { "scaleproof " (env!("CARGO_PKG_VERSION")) ". " (foot) } }
    };
    html_page(title, STYLE, &body)
}
