//! Scores the recorded detections of a session and compares its variants: `cargo run --release --example score_a_session -- SESSION REPORT`

use std::error::Error;
use std::path::PathBuf;

use scaleproof::{ApDefinition, EvaluatedDetector, Manifest, Options, Session};
use scaleproof::{compare, score, summary_table, write_report};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [folder, report] = &arguments[..] else {
        return Err("give a session and a folder for the report".into());
    };
    let session = Session::open(folder)?;
    let class = &session.scene.model.class;
    let detectors = Manifest::all()?
        .into_iter()
        .map(|manifest| EvaluatedDetector::recorded(manifest, &[&session.folder], class))
        .collect::<Result<Vec<_>, _>>()?;
    let scores = score(vec![session], detectors, &Options::default(), || ())?;
    println!("{}", summary_table(&scores));
    println!("{}", write_report(report, &scores, None)?.display());
    for compared in compare(&scores, "normal", ApDefinition::default())?.results {
        let drop = compared.hit_rate.rate.drop;
        println!(
            "{} {}: hit rate lower by {drop:.2}",
            compared.detector, compared.variant
        );
    }
    Ok(())
}
