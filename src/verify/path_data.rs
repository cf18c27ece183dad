//! Path data of an SVG with its arcs as precise as its numbers.
//!
//! kurbo reads all path data, but turns arcs into cubics within a tenth of a unit, which is too coarse to judge a
//! file by. So data in absolute `M`, `L`, `C`, `A` and `Z`, as Openwork writes them, is read here; what has no arcs, or
//! has other commands, is left to kurbo.

use kurbo::{Arc, BezPath, Point, SvgArc, Vec2};

/// The tolerance for arcs as cubics, in units of the data.
const ARC_TOLERANCE: f64 = 1e-6;

/// The path, in the units of the data.
///
/// # Errors
/// What is wrong with the data.
pub(super) fn bez_path(data: &str) -> Result<BezPath, String> {
    if data.contains(['A', 'a'])
        && let Some(path) = with_arcs(data)
    {
        return Ok(path);
    }
    BezPath::from_svg(data).map_err(|e| e.to_string())
}

/// The path, if its data has only the commands that are read here.
fn with_arcs(data: &str) -> Option<BezPath> {
    let mut path = BezPath::new();
    let (mut at, mut start) = (Point::ZERO, Point::ZERO);
    let mut rest = data.trim_start();
    while let Some(command) = rest.chars().next() {
        let until = rest[1..].find(|c: char| c.is_ascii_alphabetic()).map_or(rest.len(), |i| i + 1);
        let (own, next) = rest.split_at(until);
        let numbers = own[1..].split([' ', ',', '\t', '\n', '\r']).filter(|s| !s.is_empty());
        let numbers: Vec<f64> = numbers.map(str::parse).collect::<Result<_, _>>().ok()?;
        let point = |n: &[f64]| Point::new(n[0], n[1]);
        match (command, &numbers[..]) {
            ('M', n @ [_, _]) => {
                (at, start) = (point(n), point(n));
                path.move_to(at);
            }
            ('L', n @ [_, _]) => {
                at = point(n);
                path.line_to(at);
            }
            ('C', n @ [_, _, _, _, _, _]) => {
                at = point(&n[4..]);
                path.curve_to(point(n), point(&n[2..]), at);
            }
            ('A', n @ [rx, ry, rotation, large, sweep, _, _]) => {
                let arc = SvgArc {
                    from: at,
                    to: point(&n[5..]),
                    radii: Vec2::new(*rx, *ry),
                    x_rotation: rotation.to_radians(),
                    large_arc: *large != 0.0,
                    sweep: *sweep != 0.0,
                };
                match Arc::from_svg_arc(&arc) {
                    Some(arc) => path.extend(arc.append_iter(ARC_TOLERANCE)),
                    None => path.line_to(arc.to),
                }
                at = arc.to;
            }
            ('Z', []) => {
                path.close_path();
                at = start;
            }
            _ => return None,
        }
        rest = next.trim_start();
    }
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::Shape;

    #[test]
    fn a_large_circle_of_two_arcs_has_its_area() {
        let path = bez_path("M200 0A100 100 0 0 1 0 0A100 100 0 0 1 200 0Z").unwrap();
        assert!((path.area().abs() / (1e4 * std::f64::consts::PI) - 1.0).abs() < 1e-7);
    }

    #[test]
    fn other_data_is_left_to_the_library() {
        for data in ["M0 0h10v10z", "m0 0a5 5 0 0 1 10 0z", "M0 0L10,0 10,10Z"] {
            assert_eq!(bez_path(data).unwrap(), BezPath::from_svg(data).unwrap(), "{data}");
        }
        assert!(bez_path("M0 0A1 1").is_err());
    }
}
