//! One exemplar cut by events of at least three persistences, one picture under the other.
//!
//!     cargo run --release --example persistences -- EXEMPLAR.svg PICTURE.png

use std::error::Error;
use std::path::PathBuf;

use openwork::analysis::Analysis;
use openwork::exemplar::{Exemplar, ReadOptions};
use openwork::pieces::CostWeights;
use openwork::planar::Tolerances;
use openwork::reeb::SlicingRule;
use resvg::tiny_skia::{Pixmap, PixmapPaint, Transform};

/// In parts of the exemplar's width.
const PARTS: [f64; 3] = [0.0, SlicingRule::DEFAULT_PERSISTENCE, 0.02];
const PIXELS: u32 = 1400;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let file = arguments.next().unwrap_or_else(|| "fixtures/exemplars/vine.svg".into());
    let picture = arguments.next().unwrap_or_else(|| std::env::temp_dir().join("persistences.png"));
    let exemplar = Exemplar::read(&file, &ReadOptions::default())?;
    let (low, high) = exemplar.region().bounds_mm().unwrap_or_default();
    let mut overlays = Vec::new();
    for part in PARTS {
        let rule = SlicingRule::Reeb { persistence_mm: part * (high.x - low.x) };
        let analysis = Analysis::new(&exemplar, Some(rule), &Tolerances::default(), &CostWeights::default())?;
        println!("{part} W: {} pieces", analysis.pieces.len());
        overlays.push(Pixmap::decode_png(&analysis.overlay_png(PIXELS)?)?);
    }
    let width = overlays.iter().map(Pixmap::width).max().unwrap_or(1);
    let height = overlays.iter().map(Pixmap::height).sum();
    let mut sheet = Pixmap::new(width, height).ok_or("no picture can have this size")?;
    let mut top = 0;
    for overlay in &overlays {
        sheet.draw_pixmap(0, top, overlay.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
        top += overlay.height() as i32;
    }
    std::fs::write(&picture, sheet.encode_png()?)?;
    println!("wrote {}", picture.display());
    Ok(())
}
