//! The promise, on random exemplars: what was written has the topology that was planned.

use openwork::domain::CurveSpec;
use openwork::job::{BandBuilder, JobError, Output};
use openwork::verify;
use proptest::prelude::*;

/// A strand: a wavy band of ink from end to end, or an island of it.
#[derive(Debug, Clone)]
struct Strand {
    middle: f64,
    swing: f64,
    waves: f64,
    from: f64,
    to: f64,
    half: f64,
}

fn strand() -> impl Strategy<Value = Strand> {
    (2.0f64..16.0, 0.0f64..3.0, 0.5f64..4.0, 0.0f64..15.0, 25.0f64..40.0, 0.3f64..0.9, any::<bool>())
        .prop_map(|(middle, swing, waves, from, to, half, whole)| {
            let (from, to) = if whole { (0.0, 40.0) } else { (from, to) };
            Strand { middle, swing, waves, from, to, half }
        })
}

/// A bead that joins strands, with or without an eye.
fn bead() -> impl Strategy<Value = (f64, f64, f64, bool)> {
    (3.0f64..37.0, 3.0f64..15.0, 1.0f64..3.0, any::<bool>())
}

fn svg(strands: &[Strand], beads: &[(f64, f64, f64, bool)]) -> String {
    let mut elements = String::new();
    for s in strands {
        let n = 60;
        let at = |i: usize| {
            let x = s.from + (s.to - s.from) * i as f64 / n as f64;
            (x, s.middle + s.swing * (x / 40.0 * s.waves * std::f64::consts::TAU).sin())
        };
        let upper = (0..=n).map(|i| (at(i).0, at(i).1 - s.half));
        let lower = (0..=n).rev().map(|i| (at(i).0, at(i).1 + s.half));
        let points: Vec<String> = upper.chain(lower).map(|(x, y)| format!("{x:.4},{y:.4}")).collect();
        elements += &format!("<polygon points=\"{}\"/>\n", points.join(" "));
    }
    for (x, y, r, eye) in beads {
        let inner = r * 0.4;
        let circle = |r: f64| {
            format!(
                "M{:.4} {y:.4}a{r:.4} {r:.4} 0 1 0 {:.4} 0a{r:.4} {r:.4} 0 1 0 {:.4} 0Z",
                x - r,
                2.0 * r,
                -2.0 * r
            )
        };
        let d = if *eye { circle(*r) + &circle(inner) } else { circle(*r) };
        elements += &format!("<path fill-rule=\"evenodd\" d=\"{d}\"/>\n");
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"20mm\" viewBox=\"0 0 40 20\">\n{elements}</svg>\n"
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn files_have_the_planned_topology(
        strands in prop::collection::vec(strand(), 1..5),
        beads in prop::collection::vec(bead(), 0..5),
        along in prop::sample::select(vec!["line:90mm", "line:150mm", "circle:40mm", "path:fixtures/curves/wave.svg"]),
        components in prop::option::of(1u32..3),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let exemplar = folder.path().join("exemplar.svg");
        std::fs::write(&exemplar, svg(&strands, &beads)).unwrap();
        let along: CurveSpec = along.parse().unwrap();
        let mut builder = BandBuilder::new(&exemplar, along).width_mm(10.0);
        if let Some(n) = components {
            builder = builder.components(n);
        }
        let band = match builder.build().unwrap().run(&mut |_| {}) {
            Ok(band) => band,
            // Some random exemplars cannot meet a constraint; nothing else may stop them.
            Err(JobError::Refused(_) | JobError::SearchTooLarge { .. }) => return Ok(()),
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let planned = band.topology();
        prop_assert!(components.is_none_or(|n| n == planned.components));
        let (drawing, solid) = (folder.path().join("band.svg"), folder.path().join("band.stl"));
        let outputs = [Output::file(&drawing).unwrap(), Output::file(&solid).unwrap()];
        band.write(&outputs, None, &mut |_| {}).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let found = verify::read_svg(&std::fs::read(&drawing).unwrap(), 0.002).unwrap();
        prop_assert_eq!((found.components, found.holes), (planned.components as usize, planned.holes as usize));
        let found = verify::read_stl(&std::fs::read(&solid).unwrap()).unwrap();
        prop_assert_eq!(found.shells.len(), planned.components as usize);
        prop_assert_eq!(found.genus, i64::from(planned.holes));
        prop_assert!(found.faults.is_empty());
    }
}
