//! Prints a pattern over a panel of 600 × 300 mm as tiled sheets: `cargo run --release --example print_a_template -- PATTERN.png TEMPLATE.pdf`

use std::error::Error;
use std::path::PathBuf;

use scaleproof::{Front, LayoutRequest, Media, Orientation, Paper, Pattern, TemplateRequest, template, write_pdf};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [pattern, output] = &arguments[..] else {
        return Err("give a pattern and the PDF to write".into());
    };
    let request = TemplateRequest {
        tile_mm: 118.0,
        scale: 10.0,
        pattern_name: pattern.display().to_string(),
        front: Front::Left,
        layout: LayoutRequest {
            size_mm: (600.0, 300.0),
            media: Media::new(Paper::A4),
            orientation: Orientation::Auto,
            overlap_mm: 8.0,
            bleed_mm: 2.0,
        },
    };
    let made = template(&Pattern::load(pattern)?, &request)?;
    std::fs::write(output, write_pdf("template", &made.pages)?)?;
    println!("{} pages", made.pages.len());
    Ok(())
}
