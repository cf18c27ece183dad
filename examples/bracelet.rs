//! A bracelet in one piece that closes on itself, as a drawing for a laser and a solid for a printer.
//!
//!     cargo run --example bracelet [FOLDER]

use std::error::Error;
use std::path::PathBuf;

use openwork::job::{BandBuilder, Output};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let exemplar = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars/vine.svg");

    let bracelet = BandBuilder::new(exemplar, "circle:65mm".parse()?)
        .width_mm(14.0)
        .components(1)
        .closed_pattern(true)
        .thickness_mm(3.0)
        .build()?
        .run(&mut |stage| eprintln!("{} ...", stage.name()))?;

    // Both files are read again and counted before they get their names.
    let outputs = [Output::file(folder.join("bracelet.svg"))?, Output::file(folder.join("bracelet.stl"))?];
    let report = bracelet.write(&outputs, None, &mut |_| {})?;

    println!("{} component, {} holes", report.components, report.holes);
    for file in &report.made.files {
        println!("{file}");
    }
    Ok(())
}
