//! The reader for DXF: the entities of its model space as lines and arcs in millimetres.
//!
//! A DXF is pairs of a group code and a value, each on a line of its own. Of the header only the unit matters; of the
//! rest, the entities that a cutter can follow: polylines with bulges, lines, arcs, circles, ellipses and splines. All
//! that paints something else, or refers to a block, is refused, as a count without it would be wrong. Excluded: binary
//! DXF, and anything that stands on paper space.

use std::f64::consts::TAU;

use glam::DVec2;

use super::cutlines::{CutPath, CutReport, judge};
use super::error::VerifyError;
use super::spline::Spline;
use super::stretches::Stretch;

/// The largest file that is read.
const MAX_BYTES: usize = 256 << 20;
/// Splines and ellipses become lines within this part of the chord error, so that judging them adds little to it.
const FLATTENING: f64 = 0.1;
/// `$INSUNITS`: the number, the name and the millimetres of units that parts are drawn in.
const UNITS: [(i64, &str, f64); 9] = [
    (1, "inches", 25.4),
    (2, "feet", 304.8),
    (4, "millimetres", 1.0),
    (5, "centimetres", 10.0),
    (6, "metres", 1000.0),
    (9, "mils", 0.0254),
    (10, "yards", 914.4),
    (13, "micrometres", 1e-3),
    (14, "decimetres", 100.0),
];
/// Entities that paint nothing a cutter would follow, and no counts depend on.
const HARMLESS: [&str; 2] = ["VIEWPORT", "SEQEND"];

/// Reads a DXF and counts what its lines cut out by the even-odd rule, with curves as polygons within `chord_mm`.
///
/// # Errors
/// [`VerifyError`] when the bytes are no text DXF, or when something in it cannot be judged.
pub fn read_dxf(bytes: &[u8], chord_mm: f64) -> Result<CutReport, VerifyError> {
    if bytes.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err(wrong(1, "it is a binary DXF; save it as text (ASCII)"));
    }
    // Names in old files may have another encoding; numbers and codes have none.
    let text = String::from_utf8_lossy(bytes);
    let pairs = pairs(&text)?;
    let (unit, scale, warnings) = unit(&pairs)?;
    let reader = Reader { scale, chord_mm };
    let mut paths = Vec::new();
    let mut groups = section(&pairs, "ENTITIES")
        .ok_or_else(|| wrong(1, "there is no ENTITIES section; a DXF drawing is wanted"))?
        .chunk_by(|_, b| b.code != 0)
        .peekable();
    while let Some(group) = groups.next() {
        let entity = Entity(group);
        let mut vertices = Vec::new();
        if entity.kind() == "POLYLINE" {
            while let Some(next) = groups.next_if(|next| matches!(next[0].value, "VERTEX" | "SEQEND")) {
                vertices.push(Entity(next));
            }
        }
        // 67 is set for what stands on paper.
        if entity.integer(67)? != Some(1) && !HARMLESS.contains(&entity.kind()) {
            paths.extend(reader.path(&entity, &vertices)?);
        }
    }
    judge(paths, unit, warnings, chord_mm)
}

/// A group code and its value, which stands on `line`.
#[derive(Clone, Copy)]
struct Pair<'a> {
    code: i32,
    value: &'a str,
    line: u32,
}

fn wrong(line: u32, message: impl Into<String>) -> VerifyError {
    VerifyError::Dxf { line, message: message.into() }
}

fn pairs(text: &str) -> Result<Vec<Pair<'_>>, VerifyError> {
    let mut lines = (1..).zip(text.lines());
    let mut pairs = Vec::new();
    while let Some((line, code)) = lines.next() {
        let Some((at, value)) = lines.next() else {
            if code.trim().is_empty() {
                break;
            }
            return Err(wrong(line, "a group code without a value: the file was cut off"));
        };
        let code = code.trim();
        let code = code
            .parse()
            .map_err(|_| wrong(line, format!("'{code:.20}' is no group code; a DXF is wanted")))?;
        pairs.push(Pair { code, value: value.trim(), line: at });
    }
    Ok(pairs)
}

/// What is between the name of a section and its end.
fn section<'p, 'a>(pairs: &'p [Pair<'a>], name: &str) -> Option<&'p [Pair<'a>]> {
    let is = |pair: &Pair<'_>, code: i32, value: &str| pair.code == code && pair.value == value;
    let begins = pairs.windows(2).position(|w| is(&w[0], 0, "SECTION") && is(&w[1], 2, name))? + 2;
    let length = pairs[begins..].iter().position(|pair| is(pair, 0, "ENDSEC"))?;
    Some(&pairs[begins..begins + length])
}

/// The unit of the file, its millimetres, and what is uncertain about it.
fn unit(pairs: &[Pair<'_>]) -> Result<(&'static str, f64, Vec<String>), VerifyError> {
    let header = section(pairs, "HEADER").unwrap_or_default();
    let variable = header.windows(2).find(|w| w[0].code == 9 && w[0].value == "$INSUNITS").map(|w| w[1]);
    let guess = |what: &str| {
        let warning =
            format!("{what}: lengths are taken as millimetres, and other programs may take them as inches");
        Ok(("millimetres, assumed", 1.0, vec![warning]))
    };
    let Some(pair) = variable else { return guess("the file does not say its unit ($INSUNITS)") };
    match integer(&pair)? {
        0 => guess("the file says that it has no unit ($INSUNITS 0)"),
        number => match UNITS.iter().find(|unit| unit.0 == number) {
            Some(&(_, name, scale)) => Ok((name, scale, Vec::new())),
            None => Err(wrong(
                pair.line,
                format!("the unit $INSUNITS {number} is unknown; save it in millimetres (4)"),
            )),
        },
    }
}

fn number(pair: &Pair<'_>) -> Result<f64, VerifyError> {
    pair.value.parse().map_err(|_| wrong(pair.line, format!("'{:.20}' is no number", pair.value)))
}

fn integer(pair: &Pair<'_>) -> Result<i64, VerifyError> {
    pair.value.parse().map_err(|_| wrong(pair.line, format!("'{:.20}' is no whole number", pair.value)))
}

/// The pairs of an entity, its kind first.
struct Entity<'p, 'a>(&'p [Pair<'a>]);

impl<'a> Entity<'_, 'a> {
    fn kind(&self) -> &'a str {
        self.0[0].value
    }

    /// How it is called in messages.
    fn name(&self) -> String {
        format!("{} on line {}", self.kind(), self.0[0].line)
    }

    fn unsupported(&self, what: &str) -> VerifyError {
        wrong(self.0[0].line, format!("{}: {what}", self.kind()))
    }

    fn pair(&self, code: i32) -> Option<&Pair<'a>> {
        self.0.iter().find(|pair| pair.code == code)
    }

    fn number(&self, code: i32) -> Result<Option<f64>, VerifyError> {
        self.pair(code).map(number).transpose()
    }

    fn integer(&self, code: i32) -> Result<Option<i64>, VerifyError> {
        self.pair(code).map(integer).transpose()
    }

    fn flags(&self) -> Result<i64, VerifyError> {
        Ok(self.integer(70)?.unwrap_or(0))
    }

    fn wanted(&self, code: i32) -> Result<f64, VerifyError> {
        self.number(code)?.ok_or_else(|| self.unsupported(&format!("it has no value of group code {code}")))
    }

    /// A point of which x has this code.
    fn point(&self, code: i32) -> Result<DVec2, VerifyError> {
        Ok(DVec2::new(self.wanted(code)?, self.wanted(code + 10)?))
    }

    fn numbers(&self, code: i32) -> Result<Vec<f64>, VerifyError> {
        self.0.iter().filter(|pair| pair.code == code).map(number).collect()
    }

    fn points(&self, code: i32) -> Result<Vec<DVec2>, VerifyError> {
        let (x, y) = (self.numbers(code)?, self.numbers(code + 10)?);
        if x.len() != y.len() {
            return Err(self.unsupported("its points have not as many y as x"));
        }
        Ok(x.into_iter().zip(y).map(DVec2::from).collect())
    }

    /// Whether its plane is seen from behind, so that x is mirrored.
    fn is_mirrored(&self) -> Result<bool, VerifyError> {
        let normal =
            [210, 220, 230].map(|code| self.number(code).map(|n| n.unwrap_or(f64::from(code == 230))));
        let [x, y, z] = normal;
        let (x, y, z) = (x?, y?, z?);
        if x.abs().max(y.abs()) > 1e-9 || z == 0.0 {
            return Err(self.unsupported("it does not lie in the plane of the drawing; flatten the drawing"));
        }
        Ok(z < 0.0)
    }
}

struct Reader {
    scale: f64,
    chord_mm: f64,
}

impl Reader {
    fn path(
        &self,
        entity: &Entity<'_, '_>,
        vertices: &[Entity<'_, '_>],
    ) -> Result<Option<CutPath>, VerifyError> {
        let is_mirrored = entity.is_mirrored()?;
        // Lines, splines and ellipses stand in the drawing's own coordinates, whatever their plane.
        let own = matches!(entity.kind(), "LINE" | "SPLINE" | "ELLIPSE");
        let side = if is_mirrored && !own { -1.0 } else { 1.0 };
        let place = |p: DVec2| DVec2::new(side * p.x, p.y) * self.scale;
        let mut says_closed = false;
        let stretches = match entity.kind() {
            "LINE" => vec![Stretch::Line(place(entity.point(10)?), place(entity.point(11)?))],
            "ARC" | "CIRCLE" => {
                let (centre, radius) = (place(entity.point(10)?), entity.wanted(40)? * self.scale);
                let (from, turn) = match entity.kind() {
                    "CIRCLE" => (0.0, TAU),
                    _ => {
                        let (from, to) = (entity.wanted(50)?.to_radians(), entity.wanted(51)?.to_radians());
                        let turn = (to - from).rem_euclid(TAU);
                        (from, if turn == 0.0 { TAU } else { turn })
                    }
                };
                if radius <= 0.0 {
                    return Err(entity.unsupported("its radius is not positive"));
                }
                says_closed = turn == TAU;
                let at = |angle: f64| {
                    let d = DVec2::from_angle(angle);
                    centre + radius * DVec2::new(side * d.x, d.y)
                };
                let to = if says_closed { at(from) } else { at(from + turn) };
                vec![Stretch::Arc { centre, from: at(from), turn: side * turn, to }]
            }
            "ELLIPSE" => {
                let direction = if is_mirrored { -1.0 } else { 1.0 };
                let (centre, major) = (entity.point(10)?, entity.point(11)?);
                let minor = major.perp() * entity.wanted(40)? * direction;
                let (from, to) = (entity.number(41)?.unwrap_or(0.0), entity.number(42)?.unwrap_or(TAU));
                let turn = if to > from { to - from } else { to - from + TAU };
                says_closed = (turn - TAU).abs() < 1e-9;
                let step = (8.0 * FLATTENING * self.chord_mm / (major.length() * self.scale)).sqrt();
                let n = (turn / step).ceil().clamp(8.0, 1e6) as u32;
                let at = |i: u32| {
                    let angle = from + turn * f64::from(if says_closed { i % n } else { i }) / f64::from(n);
                    place(centre + major * angle.cos() + minor * angle.sin())
                };
                (0..n).map(|i| Stretch::Line(at(i), at(i + 1))).collect()
            }
            "LWPOLYLINE" => {
                says_closed = entity.flags()? & 1 != 0;
                let mut points: Vec<(DVec2, f64)> = Vec::new();
                let mut xs = entity.points(10)?.into_iter();
                for pair in entity.0 {
                    match (pair.code, points.last_mut()) {
                        (10, _) => points.extend(xs.next().map(|p| (place(p), 0.0))),
                        (42, Some(last)) => last.1 = side * number(pair)?,
                        _ => {}
                    }
                }
                polyline(&points, says_closed)
            }
            "POLYLINE" => {
                let flags = entity.flags()?;
                if flags & (8 | 16 | 64) != 0 {
                    return Err(
                        entity.unsupported("it is a line in space or a mesh; save it as a flat polyline")
                    );
                }
                says_closed = flags & 1 != 0;
                let mut points = Vec::new();
                for vertex in vertices.iter().filter(|v| v.kind() == "VERTEX") {
                    // 16 marks the frame of a fitted spline, which is not drawn.
                    if vertex.flags()? & 16 == 0 {
                        points.push((place(vertex.point(10)?), side * vertex.number(42)?.unwrap_or(0.0)));
                    }
                }
                polyline(&points, says_closed)
            }
            "SPLINE" => {
                says_closed = entity.flags()? & 1 != 0;
                let control = entity.points(10)?.into_iter().map(place).collect();
                let degree = entity.integer(71)?.unwrap_or(3);
                let spline = Spline::new(degree, entity.numbers(40)?, control, entity.numbers(41)?);
                let spline = spline.map_err(|what| entity.unsupported(what))?;
                let points = spline.flattened(FLATTENING * self.chord_mm);
                let lines = points.windows(2).filter(|w| w[0] != w[1]);
                lines.map(|w| Stretch::Line(w[0], w[1])).collect()
            }
            "INSERT" => return Err(entity.unsupported("a block cannot be judged; explode it")),
            _ => {
                return Err(
                    entity.unsupported("it is no path that can be cut; convert it to lines, or remove it")
                );
            }
        };
        let (Some(first), Some(last)) = (stretches.first(), stretches.last()) else { return Ok(None) };
        let is_finite =
            stretches.iter().all(|s| s.from().is_finite() && s.to().is_finite() && s.length_mm().is_finite());
        if !is_finite {
            return Err(entity.unsupported("a coordinate is not a finite number"));
        }
        let is_closed = says_closed || (stretches.len() > 1 && first.from() == last.to());
        let layer = entity.pair(8).map_or("0", |pair| pair.value).to_owned();
        Ok(Some(CutPath { element: entity.name(), layer, stretches, is_closed }))
    }
}

/// The lines and arcs of a polyline; each point has the bulge of what follows.
fn polyline(points: &[(DVec2, f64)], is_closed: bool) -> Vec<Stretch> {
    let n = points.len();
    let last = if is_closed { n } else { n.saturating_sub(1) };
    let stretch = |i: usize| {
        let ((from, bulge), (to, _)) = (points[i], points[(i + 1) % n]);
        (from != to).then(|| match bulge {
            0.0 => Stretch::Line(from, to),
            // The tangent of half of the turn's half says how far the centre is from the chord.
            bulge => {
                let across = (to - from).perp() * ((1.0 / bulge - bulge) / 4.0);
                Stretch::Arc { centre: from.midpoint(to) + across, from, turn: 4.0 * bulge.atan(), to }
            }
        })
    };
    (0..last).filter_map(stretch).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{CutFault, Expected, Mismatch};
    use super::*;

    const CHORD: f64 = 0.01;

    /// A DXF of entities, each as `kind code value code value ...`; with a unit.
    fn file(unit: Option<i64>, entities: &[&str]) -> String {
        let unit = unit.map_or_else(String::new, |n| format!("9\n$INSUNITS\n70\n{n}\n"));
        let entities: String = entities.iter().map(|e| format!("0\n{}\n", e.replace(' ', "\n"))).collect();
        format!(
            "0\nSECTION\n2\nHEADER\n{unit}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
        )
    }

    fn read(entities: &[&str]) -> CutReport {
        read_dxf(file(Some(4), entities).as_bytes(), CHORD).unwrap()
    }

    const SQUARE: &str = "LWPOLYLINE 8 CUT 90 4 70 1 10 0 20 0 10 20 20 0 10 20 20 20 10 0 20 20";
    const HOLE: &str = "LWPOLYLINE 8 CUT 90 4 70 1 10 5 20 5 10 10 20 5 10 10 20 10 10 5 20 10";

    #[test]
    fn polylines_are_counted_by_the_even_odd_rule() {
        let report = read(&[HOLE, SQUARE]);
        assert_eq!((report.components, report.holes, report.pierces), (1, 1, 2));
        assert_eq!((report.faults.as_slice(), report.warnings.len()), (&[][..], 0));
        assert!((report.area_mm2 - 375.0).abs() < 1e-6 && (report.cut_length_mm - 100.0).abs() < 1e-9);
        let wanted = Expected {
            components: Some(1.into()),
            holes: Some(1.into()),
            min_feature_mm: 1.0,
            min_gap_mm: 1.0,
        };
        assert_eq!(report.check(&wanted), Ok(()));
        let wanted = Expected { holes: Some(0.into()), ..wanted };
        assert_eq!(report.check(&wanted), Err(Mismatch::Holes { found: 1, wanted: 0.into() }));
    }

    #[test]
    fn units_are_millimetres_inches_or_a_warning() {
        let circle = "CIRCLE 8 0 10 1 20 1 40 1";
        for (unit, side) in [(Some(4), 2.0), (Some(1), 50.8), (Some(5), 20.0), (None, 2.0), (Some(0), 2.0)] {
            let report = read_dxf(file(unit, &[circle]).as_bytes(), CHORD).unwrap();
            let (low, high) = report.bounds_mm.unwrap();
            assert!(((high - low).x - side).abs() < 0.03, "{unit:?}");
            assert_eq!(report.warnings.len(), usize::from(unit.is_none_or(|n| n == 0)));
        }
        let error = read_dxf(file(Some(99), &[circle]).as_bytes(), CHORD).unwrap_err();
        assert!(error.to_string().contains("$INSUNITS 99"), "{error}");
    }

    #[test]
    fn loose_lines_and_arcs_that_go_on_in_each_other_are_contours() {
        // A half disc: an arc from the right to the left, and two lines back, one of them turned round.
        let arc = "ARC 8 0 10 0 20 0 40 5 50 0 51 180";
        let lines = ["LINE 8 0 10 0 20 0 11 -5 21 0", "LINE 8 0 10 0 20 0 11 5 21 0"];
        let report = read(&[lines[0], arc, lines[1]]);
        assert_eq!(
            (report.components, report.pierces, report.faults.len()),
            (1, 1, 0),
            "{:?}",
            report.faults
        );
        assert!((report.area_mm2 - 12.5 * std::f64::consts::PI).abs() < 0.2);
        let open = read(&[arc, lines[0]]);
        let [CutFault::Open { position_mm, .. }] = &open.faults[..] else { panic!("{:?}", open.faults) };
        assert!(position_mm.distance(DVec2::new(5.0, 0.0)) < 1e-9 || position_mm.length() < 1e-9);
        assert!(matches!(open.check(&Expected::default()), Err(Mismatch::Cuts { count: 1, .. })));
    }

    #[test]
    fn bulges_ellipses_and_old_polylines_have_their_areas() {
        let disc = "LWPOLYLINE 8 0 70 1 10 -3 20 0 42 1 10 3 20 0 42 1";
        let mirrored = "LWPOLYLINE 8 0 70 1 10 -3 20 0 42 1 10 3 20 0 42 1 210 0 220 0 230 -1";
        let old = "POLYLINE 8 0 66 1 70 1";
        let vertices = ["VERTEX 8 0 10 -3 20 0 42 1", "VERTEX 8 0 10 3 20 0 42 1", "SEQEND 8 0"];
        let ellipse = "ELLIPSE 8 0 10 0 20 0 11 6 21 0 40 0.25 41 0 42 6.283185307179586";
        let spline = "SPLINE 8 0 70 8 71 2 40 0 40 0 40 0 40 1 40 1 40 2 40 2 40 3 40 3 40 4 40 4 40 4 \
            10 3 20 0 41 1 10 3 20 3 41 0.7071067811865476 10 0 20 3 41 1 10 -3 20 3 41 0.7071067811865476 10 -3 20 0 \
            41 1 10 -3 20 -3 41 0.7071067811865476 10 0 20 -3 41 1 10 3 20 -3 41 0.7071067811865476 10 3 20 0 41 1";
        for entities in
            [&[disc][..], &[mirrored], &[old, vertices[0], vertices[1], vertices[2]], &[ellipse], &[spline]]
        {
            let report = read(entities);
            assert_eq!((report.components, report.faults.len()), (1, 0), "{entities:?} {:?}", report.faults);
            assert!(
                (report.area_mm2 - 9.0 * std::f64::consts::PI).abs() < 0.2,
                "{entities:?} {}",
                report.area_mm2
            );
        }
    }

    #[test]
    fn double_cuts_crossings_and_the_wrong_order_are_faults() {
        let twice = read(&[SQUARE, SQUARE]);
        assert_eq!(twice.faults.iter().filter(|f| matches!(f, CutFault::Doubled { .. })).count(), 4);
        let crossing = read(&[SQUARE, "CIRCLE 8 0 10 20 20 10 40 3"]);
        assert!(
            crossing.faults.iter().any(|f| matches!(f, CutFault::Crossing { .. })),
            "{:?}",
            crossing.faults
        );
        let early = read(&[SQUARE, HOLE]);
        assert!(matches!(early.faults[..], [CutFault::Order { .. }]), "{:?}", early.faults);
        let shared = read(&[HOLE, SQUARE, "LINE 8 0 10 5 20 0 11 9 21 0"]);
        let kinds =
            |f: &CutFault| matches!(f, CutFault::Doubled { length_mm, .. } if (length_mm - 4.0).abs() < 1e-9);
        assert!(shared.faults.iter().any(kinds), "{:?}", shared.faults);
    }

    #[test]
    fn layers_that_are_not_cut_do_not_count() {
        let sheet = "LWPOLYLINE 8 SHEET 70 1 10 -9 20 -9 10 90 20 -9 10 90 20 90 10 -9 20 90";
        let report = read(&[sheet, HOLE, SQUARE, "LINE 8 Engrave 10 1 20 1 11 2 21 1"]);
        assert_eq!((report.components, report.holes, report.faults.len()), (1, 1, 0));
        let cut: Vec<(&str, bool)> = report.layers.iter().map(|l| (l.name.as_str(), l.is_cut)).collect();
        assert_eq!(cut, [("CUT", true), ("Engrave", false), ("SHEET", false)]);
    }

    #[test]
    fn what_cannot_be_judged_is_refused_with_its_line() {
        for (entity, part) in [
            ("INSERT 8 0 2 part 10 0 20 0", "explode it"),
            ("TEXT 8 0 10 0 20 0 40 5 1 A", "no path that can be cut"),
            ("CIRCLE 8 0 10 0 20 0 40 -1", "radius"),
            ("LINE 8 0 10 x 20 0 11 1 21 1", "'x' is no number"),
            ("LINE 8 0 10 nan 20 0 11 1 21 1", "finite"),
            ("LINE 8 0 10 0 20 0 11 1", "group code 21"),
            ("SPLINE 8 0 71 3 11 0 21 0", "control points"),
            ("LINE 8 0 10 1e9 20 0 11 1 21 1", "units"),
        ] {
            let error = read_dxf(file(Some(4), &[entity]).as_bytes(), CHORD).unwrap_err().to_string();
            assert!(error.contains(part), "{entity}: {error}");
        }
        for (bytes, part) in [
            (&b"<svg/>"[..], "group code"),
            (b"0\nSECTION\n2\nHEADER\n0\nENDSEC\n", "ENTITIES"),
            (b"AutoCAD Binary DXF\r\n\x1a\0", "binary"),
        ] {
            let error = read_dxf(bytes, CHORD).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
