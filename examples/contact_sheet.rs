//! A contact sheet: drawings side by side in one picture.
//!
//! `cargo run --release --example contact_sheet -- SHEET.png COLUMNS FILE.svg...`, where `1x1400` is one column 1400 pixels wide;
//! without arguments, the exemplars of this project in the folder for temporary files.

use std::error::Error;
use std::path::PathBuf;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use usvg::{Options, Tree};

/// The width of a cell in pixels if none is given, its height as a part of it, and the space between cells.
const WIDTH: f32 = 300.0;
const HEIGHT: f32 = 190.0 / 300.0;
const SPACE: f32 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let sheet =
        arguments.next().map_or_else(|| std::env::temp_dir().join("contact_sheet.png"), PathBuf::from);
    let columns = arguments.next().unwrap_or_else(|| "3".to_owned());
    let (columns, width) = columns.split_once('x').unwrap_or((&columns, ""));
    let columns: usize = columns.parse()?;
    let width: f32 = if width.is_empty() { WIDTH } else { width.parse()? };
    let cell = [width, (width * HEIGHT).round()];
    let mut files: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if files.is_empty() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/exemplars"))? {
            files.push(entry?.path());
        }
        files.sort();
    }
    let step = cell.map(|length| length + SPACE);
    let size = |cells: usize, step: f32| (cells as f32 * step + SPACE) as u32;
    let rows = files.len().div_ceil(columns.max(1)).max(1);
    let mut picture = Pixmap::new(size(columns, step[0]), size(rows, step[1])).ok_or("no cells")?;
    picture.fill(Color::WHITE);
    for (i, file) in files.iter().enumerate() {
        let tree = Tree::from_data(&std::fs::read(file)?, &Options::default())?;
        let (width, height) = (tree.size().width(), tree.size().height());
        let scale = (cell[0] / width).min(cell[1] / height);
        let corner = |number: usize, axis: usize, length: f32| {
            SPACE + number as f32 * step[axis] + (cell[axis] - length * scale) / 2.0
        };
        let (x, y) = (corner(i % columns, 0, width), corner(i / columns, 1, height));
        resvg::render(&tree, Transform::from_scale(scale, scale).post_translate(x, y), &mut picture.as_mut());
    }
    std::fs::write(sheet, picture.encode_png()?)?;
    Ok(())
}
