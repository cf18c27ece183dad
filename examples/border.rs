//! A straight border with exactly the number of holes that was asked for, or the reason why there is none.
//!
//!     cargo run --example border [HOLES [FOLDER]]

use std::error::Error;
use std::path::PathBuf;

use openwork::domain::CurveSpec;
use openwork::job::{BandBuilder, JobError, Output};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let holes = arguments.next().map_or(Ok(5), |n| n.parse())?;
    let folder = arguments.next().map_or_else(std::env::temp_dir, PathBuf::from);
    let exemplar = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars/wave.svg");

    let job = BandBuilder::new(exemplar, CurveSpec::Line { length_mm: 120.0 })
        .width_mm(12.0)
        .components(1)
        .holes(holes)
        .build()?;
    let border = match job.run(&mut |_| {}) {
        // The message names the constraint and the nearest that can be had.
        Err(JobError::Refused(reason)) => {
            println!("there is no such border: {reason}");
            return Ok(());
        }
        done => done?,
    };
    let report = border.write(&[Output::file(folder.join("border.svg"))?], None, &mut |_| {})?;

    println!("{}", report.made.files[0]);
    println!("components and holes   {} and {}", report.components, report.holes);
    println!(
        "length                 {} mm, stretched from {:+.2} mm",
        report.length_mm, report.length_error_mm
    );
    println!("pieces                 {} of {}", report.pieces_in_result, report.pieces_in_exemplar);
    println!("jumps                  {} in {} seams", report.seams.jumps, report.seams.count);
    println!("worst kink at a seam   {:.1} degrees", report.seams.worst_angle_after_deg);
    if let Some(ink) = report.made.min_feature {
        let place = ink.position_mm;
        println!("narrowest ink          {:.3} mm at ({:.1}, {:.1}) mm", ink.width_mm, place.x, place.y);
    }
    Ok(())
}
