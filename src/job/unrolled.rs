//! A ring laid flat: its outline cut open across the band.
//!
//! The contours of a ring run on past its end. Wherever they cross the cut they are cut too, and what is left of them is joined along the two
//! sides of the strip that comes of it, ink to ink. Both sides then have the same ink. Excluded: where the ring lies in space.

use glam::DVec2;

use crate::fit::OutlineContour;

/// Places for the cut that are looked at.
const PLACES: usize = 720;
/// Vertices that are nearer to each other than this along the band have no room for the cut between them.
const NARROW_MM: f64 = 1e-4;
/// A cut that passes the end of a hole or of ink more closely than this leaves a sliver, which no beam makes.
const CLEAR_MM: f64 = 0.6;

/// Where the cut goes best: where as few strands as can be are cut, and those where they are widest. No vertex lies there.
pub(super) fn best_cut(contours: &[OutlineContour], length_mm: f64) -> f64 {
    let mut taken: Vec<f64> =
        contours.iter().flat_map(|c| &c.points).map(|p| p.x.rem_euclid(length_mm)).collect();
    taken.sort_unstable_by(f64::total_cmp);
    let ends = ends(contours, length_mm);
    let places: Vec<(f64, bool)> = (0..PLACES)
        .map(|k| {
            let near = (k as f64 + 0.5) / PLACES as f64 * length_mm;
            // The middle between two vertices.
            let next = taken.partition_point(|&x| x <= near);
            match (next.checked_sub(1), taken.get(next)) {
                (Some(before), Some(&after)) => {
                    (taken[before].midpoint(after), after - taken[before] < NARROW_MM)
                }
                _ => (near, false),
            }
        })
        .collect();
    let mut crossed =
        crossings(contours, length_mm, &places.iter().map(|&(place, _)| place).collect::<Vec<_>>());
    let judged = |k: usize| {
        let (place, is_narrow) = places[k];
        let crossings = &mut crossed[k];
        crossings.sort_unstable_by(f64::total_cmp);
        let ink: f64 = crossings.chunks_exact(2).map(|pair| pair[1] - pair[0]).sum();
        let next = ends.partition_point(|&x| x <= place);
        let beside = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|i| ends.get(i));
        let is_grazing = beside.map(|x| (x - place).abs()).fold(f64::INFINITY, f64::min) < CLEAR_MM;
        (is_narrow, is_grazing, crossings.len(), -ink, place)
    };
    let all = (0..PLACES).map(judged);
    let best = all.min_by(|a, b| (a.0, a.1, a.2).cmp(&(b.0, b.1, b.2)).then(a.3.total_cmp(&b.3)));
    best.expect("there are many").4
}

/// Where contours turn back along the ring: the ends of their ink and of their holes, ascending.
fn ends(contours: &[OutlineContour], length_mm: f64) -> Vec<f64> {
    let mut ends = Vec::new();
    for contour in contours {
        let edges: Vec<(DVec2, DVec2)> = edges(contour, length_mm).collect();
        let runs: Vec<f64> = edges.iter().map(|(a, b)| b.x - a.x).collect();
        let turns = (0..runs.len()).filter(|&i| runs[i] * runs[(i + 1) % runs.len()] <= 0.0);
        ends.extend(turns.map(|i| edges[i].1.x.rem_euclid(length_mm)));
    }
    ends.sort_unstable_by(f64::total_cmp);
    ends
}

/// For each of `places`, which ascend, the heights at which contours cross the line there, and those whole lengths further.
fn crossings(contours: &[OutlineContour], length_mm: f64, places: &[f64]) -> Vec<Vec<f64>> {
    let mut heights = vec![Vec::new(); places.len()];
    for (a, b) in contours.iter().flat_map(|contour| edges(contour, length_mm)) {
        let (low, high) = (a.x.min(b.x), a.x.max(b.x));
        let laps = (low / length_mm).floor() as i64..=(high / length_mm).floor() as i64;
        for start in laps.map(|lap| lap as f64 * length_mm) {
            let from = places.partition_point(|place| place + start <= low);
            let to = places.partition_point(|place| place + start <= high);
            for k in from..to {
                let t = (places[k] + start - a.x) / (b.x - a.x);
                heights[k].push(a.y + t * (b.y - a.y));
            }
        }
    }
    heights
}

fn edges(contour: &OutlineContour, length_mm: f64) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let points = &contour.points;
    let end = points.first().map(|&p| p + DVec2::new(f64::from(contour.winding) * length_mm, 0.0));
    let next = move |i: usize| points.get(i + 1).copied().or(end);
    points.iter().enumerate().filter_map(move |(i, &a)| Some((a, next(i)?)))
}

/// The ring of `length_mm` cut at `cut_mm`: closed paths with x from 0 to the length and y across, ink on the left. `None` when ink on the two sides of the cut does not pair, as where contours touch there.
pub(super) fn unrolled(contours: &[OutlineContour], length_mm: f64, cut_mm: f64) -> Option<Vec<Vec<DVec2>>> {
    let mut paths = Vec::new();
    // Open runs from side to side of the strip.
    let mut runs: Vec<Vec<DVec2>> = Vec::new();
    for contour in contours {
        let first_run = runs.len();
        let mut run: Vec<DVec2> = Vec::new();
        let mut is_cut = false;
        for (a, b) in edges(contour, length_mm) {
            let at = |p: DVec2| ((p.x - cut_mm) / length_mm, p.y);
            let ((from, y0), (to, y1)) = (at(a), at(b));
            let place = |x: f64, lap: f64, y: f64| DVec2::new((x - lap) * length_mm, y);
            let mut lap = from.floor();
            run.push(place(from, lap, y0));
            while lap != to.floor() {
                let is_forward = to > from;
                let border = if is_forward { lap + 1.0 } else { lap };
                let y = y0 + (border - from) / (to - from) * (y1 - y0);
                let [end, start] = if is_forward { [length_mm, 0.0] } else { [0.0, length_mm] };
                run.push(DVec2::new(end, y));
                runs.push(std::mem::replace(&mut run, vec![DVec2::new(start, y)]));
                lap += if is_forward { 1.0 } else { -1.0 };
                is_cut = true;
            }
        }
        if !is_cut {
            paths.push(run);
        } else {
            // The contour began inside of its first run.
            run.append(&mut runs[first_run]);
            runs[first_run] = run;
        }
    }
    join(runs, length_mm, &mut paths)?;
    Some(paths)
}

/// Joins runs along the sides of the strip to closed paths.
fn join(runs: Vec<Vec<DVec2>>, length_mm: f64, paths: &mut Vec<Vec<DVec2>>) -> Option<()> {
    // For the end of each run, the run that begins on the other end of its ink along the side.
    let mut next = vec![usize::MAX; runs.len()];
    for side in [0.0, length_mm] {
        // Height, run, and whether the run begins there.
        let mut ends: Vec<(f64, usize, bool)> = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            let (first, last) = (run[0], run[run.len() - 1]);
            ends.extend((first.x == side).then_some((first.y, i, true)));
            ends.extend((last.x == side).then_some((last.y, i, false)));
        }
        ends.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let pairs = ends.chunks_exact(2);
        if !pairs.remainder().is_empty() {
            return None;
        }
        for pair in pairs {
            let [(_, a, a_begins), (_, b, b_begins)] = [pair[0], pair[1]];
            match (a_begins, b_begins) {
                (false, true) => next[a] = b,
                (true, false) => next[b] = a,
                _ => return None,
            }
        }
    }
    let mut is_used = vec![false; runs.len()];
    for first in 0..runs.len() {
        let mut path = Vec::new();
        let mut i = first;
        while !is_used[i] {
            is_used[i] = true;
            path.extend_from_slice(&runs[i]);
            i = *next.get(i).filter(|&&i| i < runs.len())?;
        }
        if !path.is_empty() {
            paths.push(path);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contour(points: &[(f64, f64)], winding: i32) -> OutlineContour {
        OutlineContour { points: points.iter().map(|&p| p.into()).collect(), winding }
    }

    fn area(paths: &[Vec<DVec2>]) -> f64 {
        let of = |path: &Vec<DVec2>| {
            let n = path.len();
            0.5 * (0..n).map(|i| path[i].perp_dot(path[(i + 1) % n])).sum::<f64>()
        };
        paths.iter().map(of).sum()
    }

    #[test]
    fn a_band_all_round_becomes_a_rectangle() {
        // The lower border runs along, the upper one back.
        let ring = [contour(&[(1.0, 0.0), (40.0, 0.0)], 1), contour(&[(70.0, 2.0), (30.0, 2.0)], -1)];
        for cut in [0.5, 33.0, 99.0] {
            let flat = unrolled(&ring, 100.0, cut).unwrap();
            assert_eq!(flat.len(), 1);
            assert!((area(&flat) - 200.0).abs() < 1e-9, "{:?}", flat);
            assert!(flat[0].iter().all(|p| (0.0..=100.0).contains(&p.x)));
        }
    }

    #[test]
    fn an_island_over_the_cut_is_in_two_parts() {
        let island = contour(&[(95.0, 0.0), (107.0, 0.0), (107.0, 3.0), (95.0, 3.0)], 0);
        let hole = contour(&[(98.0, 1.0), (98.0, 2.0), (103.0, 2.0), (103.0, 1.0)], 0);
        let flat = unrolled(&[island.clone(), hole], 100.0, 0.1).unwrap();
        assert_eq!(flat.len(), 2);
        assert!((area(&flat) - 31.0).abs() < 1e-9, "{:?}", flat);
        let whole = unrolled(&[island], 100.0, 50.0).unwrap();
        assert_eq!(whole.len(), 1);
        assert!((area(&whole) - 36.0).abs() < 1e-9);
    }

    #[test]
    fn the_cut_goes_where_little_is_cut() {
        // All round, and a box from 20 to 90 above it.
        let ring = [
            contour(&[(0.0, 0.0)], 1),
            contour(&[(100.0, 2.0)], -1),
            contour(&[(20.0, 4.0), (90.0, 4.0), (90.0, 6.0), (20.0, 6.0)], 0),
        ];
        let cut = best_cut(&ring, 100.0);
        assert!(!(20.0..90.0).contains(&cut), "{cut}");
    }
}
