//! How far two solids are apart, and where.
//!
//! The distance is taken from the corners of each to the facets of the other. Where two edges are nearer than that to each
//! other, it is a little too large; it is for messages. Excluded: solids that overlap ([`super::overlap`]).

use glam::DVec3;

use super::solid::Solid;

/// Where two solids come closest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// The distance in millimetres.
    pub distance_mm: f64,
    /// The place on the first solid.
    pub from_mm: DVec3,
    /// The place on the second.
    pub to_mm: DVec3,
}

/// Where `a` and `b` come closest; `None` if one of them has no facets.
pub fn gap(a: &Solid, b: &Solid) -> Option<Gap> {
    let turned = |gap: Gap| Gap { from_mm: gap.to_mm, to_mm: gap.from_mm, ..gap };
    let there = nearest(a, b, f64::INFINITY);
    let back = nearest(b, a, there.map_or(f64::INFINITY, |gap| gap.distance_mm)).map(turned);
    back.or(there)
}

/// The corner of `a` that is nearest to a facet of `b`, if one is nearer than `within`.
fn nearest(a: &Solid, b: &Solid, within: f64) -> Option<Gap> {
    let corner = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
    let facets: Vec<[DVec3; 3]> = b.facets().map(|facet| facet.map(corner)).collect();
    let mut best: Option<Gap> = None;
    let mut within_squared = within * within;
    for p in a.vertices().iter().map(|&p| corner(p)) {
        for facet @ [q, r, s] in &facets {
            let (low, high) = (q.min(*r).min(*s), q.max(*r).max(*s));
            if p.distance_squared(p.clamp(low, high)) >= within_squared {
                continue;
            }
            let to = on_facet(p, facet);
            let squared = p.distance_squared(to);
            if squared < within_squared {
                within_squared = squared;
                best = Some(Gap { distance_mm: squared.sqrt(), from_mm: p, to_mm: to });
            }
        }
    }
    best
}

/// The point of a facet that is nearest to `p`.
fn on_facet(p: DVec3, [a, b, c]: &[DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let foot = p - normal * ((p - a).dot(normal) / normal.length_squared());
    let is_inside = |from: &DVec3, to: &DVec3| (to - from).cross(foot - from).dot(normal) >= 0.0;
    if is_inside(a, b) && is_inside(b, c) && is_inside(c, a) {
        return foot;
    }
    let on_side = |(from, to): (&DVec3, &DVec3)| {
        let along = to - from;
        *from + along * ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
    };
    let sides = [(a, b), (b, c), (c, a)].map(on_side);
    sides.into_iter().min_by(|p0, p1| p.distance(*p0).total_cmp(&p.distance(*p1))).expect("there are three")
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::super::solid::extrude;
    use super::super::solid::tests::rectangles;
    use super::*;

    #[test]
    fn the_place_is_on_both() {
        let plate = extrude(&rectangles(&[(0.0, 0.0, 20.0, 20.0)]), 1.0).unwrap();
        let tip = extrude(&rectangles(&[(0.0, 0.0, 2.0, 2.0)]), 2.0).unwrap();
        // On its corner above the middle of the plate.
        let turned = DAffine3::from_axis_angle(DVec3::new(1.0, -1.0, 0.0).normalize(), 0.6);
        let tip = tip.moved(&(DAffine3::from_translation(DVec3::new(9.0, 8.0, 4.0)) * turned)).unwrap();
        let lowest = tip.vertices().iter().map(|p| f64::from(p[2])).fold(f64::INFINITY, f64::min);
        let found = gap(&plate, &tip).unwrap();
        assert!((found.distance_mm - (lowest - 1.0)).abs() < 1e-5, "{found:?}");
        assert!((found.from_mm.z - 1.0).abs() < 1e-9 && (found.to_mm.z - lowest).abs() < 1e-6);
        assert_eq!(gap(&tip, &plate).unwrap().from_mm, found.to_mm);
        assert_eq!(gap(&plate, &Solid::from_facets([]).unwrap()), None);
    }
}
