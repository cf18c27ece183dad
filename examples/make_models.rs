//! The models of `fixtures/models`: an egg, and a vase without thickness.
//!
//!     cargo run --example make_models [FOLDER]
//!
//! Both are turned on a lathe: an outline is turned about the z axis in rings a step apart, with as many corners in
//! each as it takes for triangles that are nearly equilateral.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::PathBuf;

/// A place of an outline: how far it is from the axis, and how high, in millimetres.
type Place = [f64; 2];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    for (name, outline, step_mm) in [("egg", egg(), 2.15), ("vase", vase(), 3.05)] {
        let file = folder.join(name).with_extension("obj");
        std::fs::write(&file, turned(&outline, step_mm))?;
        println!("{}", file.display());
    }
    Ok(())
}

/// An egg of 60 mm, from its blunt end up.
fn egg() -> Vec<Place> {
    let place = |angle: f64| [21.6 * angle.sin() * (0.2 * angle.cos()).exp(), 30.0 - 30.0 * angle.cos()];
    let inner = (1..2000).map(|i| place(PI * f64::from(i) / 2000.0));
    // The sine of half a turn is not quite nothing.
    [[0.0, 0.0]].into_iter().chain(inner).chain([[0.0, 60.0]]).collect()
}

/// A vase of 100 mm: a foot, a belly, a neck and a lip. It begins in the middle of its bottom and is open above.
fn vase() -> Vec<Place> {
    const CURVES: [[Place; 4]; 5] = [
        [[0.0, 0.0], [5.0, 0.0], [11.0, 0.0], [16.0, 0.0]],
        [[16.0, 0.0], [19.5, 0.0], [21.5, 1.5], [22.5, 5.0]],
        [[22.5, 5.0], [26.5, 19.0], [35.0, 28.0], [35.0, 45.0]],
        [[35.0, 45.0], [35.0, 62.0], [17.5, 66.0], [17.5, 84.0]],
        [[17.5, 84.0], [17.5, 92.0], [19.5, 97.0], [25.0, 100.0]],
    ];
    let place = |[a, b, c, d]: [Place; 4], t: f64| {
        let s = 1.0 - t;
        [0, 1].map(|i| s * s * s * a[i] + 3.0 * s * s * t * b[i] + 3.0 * s * t * t * c[i] + t * t * t * d[i])
    };
    let places = CURVES.iter().flat_map(|&curve| (0..500).map(move |i| place(curve, f64::from(i) / 500.0)));
    places.chain([CURVES[4][3]]).collect()
}

/// An outline turned about the z axis, as an OBJ. What begins or ends on the axis is closed there.
fn turned(outline: &[Place], step_mm: f64) -> String {
    let rings = evenly(outline, step_mm * 0.75f64.sqrt());
    let mut text = "# millimetres\n".to_owned();
    let mut firsts = Vec::new();
    let mut next = 1;
    for (number, &[radius, z]) in rings.iter().enumerate() {
        let corners = corners(radius, step_mm);
        firsts.push((next, corners));
        next += corners;
        for i in 0..corners {
            let angle = TAU * f64::from(2 * i + turn(number)) / f64::from(2 * corners);
            // What is rounded to minus zero is zero.
            let [x, y] = [radius * angle.cos(), radius * angle.sin()].map(|x| (x * 1e3).round() / 1e3 + 0.0);
            writeln!(text, "v {x:.3} {y:.3} {z:.3}").expect("text can be written");
        }
    }
    for (number, pair) in firsts.windows(2).enumerate() {
        let [(low, n), (high, m)] = [pair[0], pair[1]];
        // Around both rings, always on with the one that is behind.
        let (mut i, mut j) = (0, 0);
        while i < n || j < m {
            let (a, b) = (low + i % n, high + j % m);
            let is_low_behind = (2 * i + 2 + turn(number)) * m <= (2 * j + 2 + turn(number + 1)) * n;
            if m == 1 || n > 1 && i < n && (j == m || is_low_behind) {
                i += 1;
                writeln!(text, "f {a} {} {b}", low + i % n).expect("text can be written");
            } else {
                j += 1;
                writeln!(text, "f {a} {} {b}", high + j % m).expect("text can be written");
            }
            // The ring of one corner, on the axis, has no side of its own.
            if (m == 1 && i == n) || (n == 1 && j == m) {
                break;
            }
        }
    }
    text
}

/// How many corners a ring has: one on the axis, and else a multiple of six.
fn corners(radius: f64, step_mm: f64) -> u32 {
    let sixths = (TAU * radius / (6.0 * step_mm)).round() as u32;
    if radius < 1e-9 { 1 } else { 6 * sixths.max(1) }
}

/// Every other ring begins half a corner later.
fn turn(ring: usize) -> u32 {
    (ring % 2) as u32
}

/// Places about `step_mm` apart along an outline, with its ends.
fn evenly(outline: &[Place], step_mm: f64) -> Vec<Place> {
    let distance = |a: Place, b: Place| (b[0] - a[0]).hypot(b[1] - a[1]);
    let mut lengths = vec![0.0];
    for pair in outline.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + distance(pair[0], pair[1]));
    }
    let length = lengths[lengths.len() - 1];
    let steps = (length / step_mm).round() as usize;
    let place = |step: usize| {
        let at = length * step as f64 / steps as f64;
        let i = lengths.partition_point(|&l| l < at).max(1);
        let part = ((at - lengths[i - 1]) / (lengths[i] - lengths[i - 1])).min(1.0);
        [0, 1].map(|k| outline[i - 1][k] + part * (outline[i][k] - outline[i - 1][k]))
    };
    let inner = (1..steps).map(place);
    [outline[0]].into_iter().chain(inner).chain([outline[outline.len() - 1]]).collect()
}
