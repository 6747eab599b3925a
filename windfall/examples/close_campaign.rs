//! What does the declared model of my runs lack? Give a campaign file; without one a bundled scenario is flown.
//!
//! `cargo run --release -p windfall --example close_campaign -- my/campaign.toml`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use windfall::prelude::*;

fn main() -> windfall::Result<()> {
    let word = std::env::args().nth(1).unwrap_or_else(|| "sage-undeclared".to_owned());
    let campaign = Campaign::find(Path::new(&word), &Fly::default())?;
    // What the reader bridged, removed or split.
    campaign.warnings.iter().for_each(|w| println!("warning: {w}"));

    let closing = campaign.close(&Close::default())?;
    println!("{}", closing.finding.sentence);
    for e in &closing.effects {
        println!("{}: {}", e.family, e.physics);
        for p in &e.parameters {
            println!("  {} = {:.6} {}, standard error {:?}", p.name, p.estimate, p.unit, p.std_error);
        }
        // What these data cannot tell from it.
        println!("  rivals: {:?}", e.rivals);
    }

    // The same page that `windfall close` writes.
    let (figures, tracks, smoothed) = (campaign.figures(&closing)?, campaign.tracks(&closing)?, campaign.smoothing(None)?);
    let page = windfall::report::closing_page(&closing, &figures, Some(&tracks), Some(&smoothed));
    windfall::files::text_atomically(&std::env::temp_dir().join("windfall-close.html"), &page)?;
    Ok(())
}
