//! Cubic Bézier curves by their control points.

use glam::DVec2;

/// The four control points, in millimetres.
pub type Cubic = [DVec2; 4];

/// The point at a parameter from 0 to 1.
pub fn point_at(cubic: &Cubic, t: f64) -> DVec2 {
    halves(cubic, t).0[3]
}

/// The two parts before and after a parameter (de Casteljau).
pub fn halves(&[p, q, r, s]: &Cubic, t: f64) -> (Cubic, Cubic) {
    let [a, b, c] = [p.lerp(q, t), q.lerp(r, t), r.lerp(s, t)];
    let [d, e] = [a.lerp(b, t), b.lerp(c, t)];
    let m = d.lerp(e, t);
    ([p, a, d, m], [m, e, c, s])
}

/// The part from one parameter to a later one.
pub fn part(cubic: &Cubic, from: f64, until: f64) -> Cubic {
    let before = halves(cubic, until).0;
    if from > 0.0 { halves(&before, from / until).1 } else { before }
}
