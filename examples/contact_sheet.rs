//! A contact sheet: drawings side by side in one picture.
//!
//! `cargo run --release --example contact_sheet -- SHEET.png COLUMNS FILE.svg...`; without arguments, the exemplars of
//! this project in the folder for temporary files.

use std::error::Error;
use std::path::PathBuf;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use usvg::{Options, Tree};

/// Pixels of a cell and of the space between cells.
const CELL: [f32; 2] = [300.0, 190.0];
const SPACE: f32 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let sheet =
        arguments.next().map_or_else(|| std::env::temp_dir().join("contact_sheet.png"), PathBuf::from);
    let columns: usize = arguments.next().as_deref().unwrap_or("3").parse()?;
    let mut files: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if files.is_empty() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars"))? {
            files.push(entry?.path());
        }
        files.sort();
    }
    let step = [CELL[0] + SPACE, CELL[1] + SPACE];
    let size = |cells: usize, step: f32| (cells as f32 * step + SPACE) as u32;
    let rows = files.len().div_ceil(columns.max(1)).max(1);
    let mut picture = Pixmap::new(size(columns, step[0]), size(rows, step[1])).ok_or("no cells")?;
    picture.fill(Color::WHITE);
    for (i, file) in files.iter().enumerate() {
        let tree = Tree::from_data(&std::fs::read(file)?, &Options::default())?;
        let (width, height) = (tree.size().width(), tree.size().height());
        let scale = (CELL[0] / width).min(CELL[1] / height);
        let corner = |cell: usize, axis: usize, length: f32| {
            SPACE + cell as f32 * step[axis] + (CELL[axis] - length * scale) / 2.0
        };
        let (x, y) = (corner(i % columns, 0, width), corner(i / columns, 1, height));
        resvg::render(&tree, Transform::from_scale(scale, scale).post_translate(x, y), &mut picture.as_mut());
    }
    std::fs::write(sheet, picture.encode_png()?)?;
    Ok(())
}
