//! Counts what a drawing or a solid holds, whoever made it.
//!
//!     cargo run --example inspect [FILE.svg|FILE.stl]

use std::error::Error;

use openwork::planar::Tolerances;
use openwork::verify::{read_stl, read_svg};

fn main() -> Result<(), Box<dyn Error>> {
    let fixture = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars/filigree.svg");
    let file = std::env::args().nth(1).unwrap_or_else(|| fixture.to_owned());
    let bytes = std::fs::read(&file)?;

    println!("{file}");
    if file.ends_with(".stl") {
        let solid = read_stl(&bytes)?;
        println!("{} shell(s), genus {}, {:.1} mm3", solid.shells.len(), solid.genus, solid.volume_mm3);
        solid.faults.iter().for_each(|fault| println!("{fault}"));
    } else {
        let drawing = read_svg(&bytes, Tolerances::DEFAULT_CHORD_MM)?;
        println!("{} component(s), {} hole(s)", drawing.components, drawing.holes);
        for (what, narrowest) in [("ink", drawing.min_feature), ("gap", drawing.min_gap)] {
            if let Some(n) = narrowest {
                let place = n.position_mm;
                println!("narrowest {what} {:.3} mm at ({:.2}, {:.2}) mm", n.width_mm, place.x, place.y);
            }
        }
        drawing.faults.iter().for_each(|fault| println!("{fault}"));
    }
    Ok(())
}
