//! The exemplars of `fixtures/samples`: six patterns of curves and elements for the engine of sample graphs.
//!
//!     cargo run --example make_samples [FOLDER]
//!
//! Each is 60 mm wide and high, drawn with a pen of 1 mm, and a little irregular, as a hand would draw it.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::PathBuf;

type Point = [f64; 2];

/// Draws the elements of a pattern.
type Draw = fn() -> String;

const SIZE_MM: f64 = 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let drawings: [(&str, Draw); 6] = [
        ("branches", branches),
        ("scales", scales),
        ("maze", maze),
        ("waves", waves),
        ("leaves", leaves),
        ("rings", rings),
    ];
    for (name, draw) in drawings {
        let file = folder.join(name).with_extension("svg");
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{SIZE_MM}mm\" height=\"{SIZE_MM}mm\" viewBox=\"0 0 {SIZE_MM} {SIZE_MM}\">\n\
             <g id=\"pattern\" fill=\"none\" stroke=\"#000\" stroke-width=\"1\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{}</g>\n</svg>\n",
            draw()
        );
        std::fs::write(&file, svg)?;
        println!("{}", file.display());
    }
    Ok(())
}

/// Numbers from 0 to 1 that are the same everywhere (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn around(&mut self, reach: f64) -> f64 {
        (self.unit() - 0.5) * 2.0 * reach
    }
}

/// Small trees that lean this way and that, with twigs on both sides.
fn branches() -> String {
    let mut random = Random(4);
    let mut svg = String::new();
    for row in 0..4 {
        for column in 0..5 {
            let shift = if row % 2 == 0 { 0.0 } else { 6.4 };
            let foot = [
                5.0 + 12.8 * f64::from(column) + shift + random.around(0.7),
                14.4 + 14.9 * f64::from(row) + random.around(0.7),
            ];
            if foot[0] > 57.0 {
                continue;
            }
            let lean = random.around(0.16);
            let bend = random.around(0.16);
            // The stem: its direction turns from lean - bend to lean + bend.
            let stem = |t: f64| {
                let angle = lean + bend * (t - 1.0);
                [foot[0] + 12.6 * t * angle.sin(), (foot[1] - 12.6 * t * angle.cos()).min(SIZE_MM - 0.6)]
            };
            smooth(&mut svg, &[0.0, 0.3, 0.65, 1.0].map(stem));
            let mut side = if random.unit() < 0.5 { 1.0 } else { -1.0 };
            for t in [0.22, 0.44, 0.68] {
                let [x, y] = stem(t + random.around(0.03));
                let length = 6.4 - 2.6 * t + random.around(0.4);
                let angle = lean + side * 1.25;
                // A twig curls up.
                let along = |share: f64| {
                    let turn = angle - side * 0.45 * share;
                    [x + length * share * turn.sin(), y - length * share * turn.cos()]
                };
                smooth(&mut svg, &[0.0, 0.5, 1.0].map(along));
                side = -side;
            }
        }
    }
    svg
}

/// Rows of round scales, each on the gaps of the row above.
fn scales() -> String {
    const RADIUS: f64 = 6.0;
    let mut svg = String::new();
    for row in 0..10 {
        let shift = if row % 2 == 0 { 0.0 } else { RADIUS };
        let y = RADIUS * f64::from(row);
        let first = if row % 2 == 0 { 0 } else { -1 };
        for column in first..5 {
            let x = shift + 2.0 * RADIUS * f64::from(column);
            let (from, to) = (x, x + 2.0 * RADIUS);
            let is_cut = [from < -1e-9, to > SIZE_MM + 1e-9];
            // Halves at both sides.
            let k = RADIUS * 0.552_284_75;
            let middle = [x + RADIUS, y + RADIUS];
            let mut d = String::new();
            if is_cut[0] {
                let _ = write!(d, "M{:.3} {:.3}", middle[0], middle[1]);
            } else {
                let _ = write!(
                    d,
                    "M{from:.3} {y:.3}C{from:.3} {:.3} {:.3} {:.3} {:.3} {:.3}",
                    y + k,
                    middle[0] - k,
                    middle[1],
                    middle[0],
                    middle[1]
                );
            }
            if !is_cut[1] {
                let _ =
                    write!(d, "C{:.3} {:.3} {to:.3} {:.3} {to:.3} {y:.3}", middle[0] + k, middle[1], y + k);
            }
            let _ = writeln!(svg, "<path d=\"{d}\"/>");
        }
    }
    svg
}

/// Walls of a maze with few loops, of which some have fallen down.
fn maze() -> String {
    const CELLS: usize = 11;
    const PITCH: f64 = 5.6;
    let mut random = Random(11);
    let at = |i: usize| [2.0 + PITCH * (i % CELLS) as f64, 2.0 + PITCH * (i / CELLS) as f64];
    // A random spanning tree of the grid's points: random edges that join what is not joined yet.
    let mut edges: Vec<(usize, usize, f64)> = Vec::new();
    for i in 0..CELLS * CELLS {
        if i % CELLS + 1 < CELLS {
            edges.push((i, i + 1, random.unit()));
        }
        if i + CELLS < CELLS * CELLS {
            edges.push((i, i + CELLS, random.unit()));
        }
    }
    edges.sort_by(|a, b| a.2.total_cmp(&b.2));
    let mut root: Vec<usize> = (0..CELLS * CELLS).collect();
    let find = |root: &[usize], mut i: usize| {
        while root[i] != i {
            i = root[i];
        }
        i
    };
    let mut walls = vec![[false; 2]; CELLS * CELLS];
    for (a, b, _) in edges {
        let (ra, rb) = (find(&root, a), find(&root, b));
        // A few close a loop.
        if ra != rb || random.unit() < 0.14 {
            root[ra] = rb;
            // Some have fallen.
            walls[a][usize::from(b != a + 1)] = random.unit() < 0.86;
        }
    }
    // Walls in a row are one line.
    let mut svg = String::new();
    for direction in 0..2 {
        let step = [1, CELLS][direction];
        for line in 0..CELLS {
            let start = line * [CELLS, 1][direction];
            let mut from = None;
            for place in 0..CELLS {
                let i = start + place * step;
                let goes_on = place + 1 < CELLS && walls[i][direction];
                match (goes_on, from) {
                    (true, None) => from = Some(i),
                    (false, Some(first)) => {
                        let ([x0, y0], [x1, y1]) = (at(first), at(i));
                        let _ = writeln!(svg, "<path d=\"M{x0:.3} {y0:.3}L{x1:.3} {y1:.3}\"/>");
                        from = None;
                    }
                    _ => {}
                }
            }
        }
    }
    svg
}

/// Lines that flow side by side, and break off here and there.
fn waves() -> String {
    const STEP: f64 = 3.0;
    let mut random = Random(23);
    let height = |row: f64, x: f64| {
        2.0 + 4.3 * row + 2.6 * (TAU * x / 31.0 + 0.28 * row).sin() + 0.9 * (TAU * x / 17.0 + row).sin()
    };
    let mut svg = String::new();
    for row in 0..14 {
        let row = f64::from(row);
        let mut x = 0.0;
        while x < SIZE_MM {
            let length = 24.0 + 40.0 * random.unit();
            let mut to = (x + length).min(SIZE_MM);
            if SIZE_MM - to < 12.0 {
                to = SIZE_MM;
            }
            let count = ((to - x) / STEP).ceil().max(2.0);
            let points: Vec<Point> = (0..=count as u32)
                .map(|i| x + (to - x) * f64::from(i) / count)
                .map(|at| [at, height(row, at)])
                .filter(|p| (0.5..=SIZE_MM - 0.5).contains(&p[1]))
                .collect();
            if points.len() > 2 {
                smooth(&mut svg, &points);
            }
            x = to + 3.6;
        }
    }
    svg
}

/// Stems with leaves on both sides, which are elements.
fn leaves() -> String {
    let mut random = Random(8);
    let mut svg = String::new();
    let mut blades = String::new();
    for stem in 0..5 {
        let x0 = 6.0 + 12.0 * f64::from(stem);
        let phase = random.unit() * TAU;
        let x = |y: f64| x0 + 1.2 * (TAU * y / 40.0 + phase).sin();
        let points: Vec<Point> = (0..=12).map(|i| 5.0 * f64::from(i)).map(|y| [x(y), y]).collect();
        smooth(&mut svg, &points);
        let mut side = if stem % 2 == 0 { 1.0 } else { -1.0 };
        let mut y = 3.0 + 3.0 * random.unit();
        while y < 58.0 {
            let turn = side * (0.95 + random.around(0.12));
            // The blade points up and away from the stem, and begins in it.
            let degrees = turn * 180.0 / PI;
            let _ = writeln!(
                blades,
                "<path class=\"leaf\" fill=\"#000\" stroke=\"none\" transform=\"translate({:.3} {y:.3}) rotate({degrees:.2})\" \
                 d=\"M0 0.3C-1.7 -1.1 -1.7 -3.3 0 -5C1.7 -3.3 1.7 -1.1 0 0.3Z\"/>",
                x(y)
            );
            side = -side;
            y += 4.4 + random.around(0.4);
        }
    }
    svg + &blades
}

/// Rings that bars join to their neighbours, and dots inside.
fn rings() -> String {
    const PITCH: f64 = 12.1;
    const RISE: f64 = 9.9;
    let mut random = Random(15);
    let mut rings: Vec<(Point, f64)> = Vec::new();
    let mut dots = String::new();
    for row in 0..6 {
        for column in 0..6 {
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 * PITCH };
            let x = 5.8 + PITCH * f64::from(column) + shift + random.around(0.35);
            let y = 5.2 + RISE * f64::from(row) + random.around(0.35);
            let radius = 4.3 + random.around(0.2);
            if x < SIZE_MM - radius - 0.5 {
                rings.push(([x, y], radius));
                let (dx, dy) = (random.around(0.25), random.around(0.25));
                let _ = writeln!(
                    dots,
                    "<circle cx=\"{:.3}\" cy=\"{:.3}\" r=\"1.6\" fill=\"#000\" stroke=\"none\"/>",
                    x + dx,
                    y + dy
                );
            }
        }
    }
    let mut svg = String::new();
    for &([x, y], radius) in &rings {
        let _ = writeln!(svg, "<circle cx=\"{x:.3}\" cy=\"{y:.3}\" r=\"{radius:.3}\"/>");
    }
    for (i, &(p, r)) in rings.iter().enumerate() {
        for &(q, s) in &rings[i + 1..] {
            let d = distance(p, q);
            if d < 14.0 {
                let (ux, uy) = ((q[0] - p[0]) / d, (q[1] - p[1]) / d);
                let _ = writeln!(
                    svg,
                    "<path d=\"M{:.3} {:.3}L{:.3} {:.3}\"/>",
                    p[0] + r * ux,
                    p[1] + r * uy,
                    q[0] - s * ux,
                    q[1] - s * uy
                );
            }
        }
    }
    svg + &dots
}

/// A path through the points, smooth (Catmull-Rom).
fn smooth(svg: &mut String, points: &[Point]) {
    let last = points.len() - 1;
    let tangent = |i: usize| {
        let (a, b) = (points[i.saturating_sub(1)], points[(i + 1).min(last)]);
        let share = if i == 0 || i == last { 1.0 / 3.0 } else { 1.0 / 6.0 };
        [(b[0] - a[0]) * share, (b[1] - a[1]) * share]
    };
    let _ = write!(svg, "<path d=\"M{:.3} {:.3}", points[0][0], points[0][1]);
    for i in 0..last {
        let (t, s) = (tangent(i), tangent(i + 1));
        let (p, q) = (points[i], points[i + 1]);
        let _ = write!(
            svg,
            "C{:.3} {:.3} {:.3} {:.3} {:.3} {:.3}",
            p[0] + t[0],
            p[1] + t[1],
            q[0] - s[0],
            q[1] - s[1],
            q[0],
            q[1]
        );
    }
    svg.push_str("\"/>\n");
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
