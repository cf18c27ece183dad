//! Each stage of a band, and the whole job in process, on three exemplars and three lengths.
//!
//! What a stage starts from is made before its clock starts. Bands are 14 mm high and in one component, at the
//! default tolerances; the chord error is shared among the stages as in a job. `cargo bench` runs all,
//! `cargo bench -- solve` only the searches.

use std::f64::consts::PI;
use std::fmt;
use std::path::{Path, PathBuf};

use divan::{Bencher, black_box};
use glam::DVec2;
use openwork::domain::{BandMap, CurveSpec, PlanarCurve};
use openwork::exemplar::{Exemplar, Limits, ReadOptions};
use openwork::export;
use openwork::fabricate::{BridgeOptions, Counts, bridge, extrude, snapped_to_f32};
use openwork::fit::{FitOptions, Outline, Sides, StitchMethod};
use openwork::job::{Band, BandBuilder, DEFAULT_MEMORY_LIMIT, Output, Plan, PlanOptions, SEED_SPREAD, plan};
use openwork::pieces::{Catalogue, CostWeights};
use openwork::planar::{Contour, FillRule, Grid, GridPoint, Region, Tolerances};
use openwork::reeb::{ReebGraph, Slicing, SlicingRule};
use openwork::topology::{Goal, Shape};
use openwork::verify;

fn main() {
    divan::main();
}

const EXEMPLARS: [&str; 3] = ["vine", "filigree", "lace"];
/// A ring for a finger, a bracelet of 65 mm, a belt.
const LENGTHS_MM: [f64; 3] = [60.0, 204.0, 600.0];
const HEIGHT_MM: f64 = 14.0;
const CHORD_MM: f64 = Tolerances::DEFAULT_CHORD_MM;

/// An exemplar and a length.
#[derive(Clone, Copy)]
struct Case {
    exemplar: &'static str,
    length_mm: f64,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} mm", self.exemplar, self.length_mm)
    }
}

fn cases() -> impl Iterator<Item = Case> {
    EXEMPLARS
        .into_iter()
        .flat_map(|exemplar| LENGTHS_MM.into_iter().map(move |length_mm| Case { exemplar, length_mm }))
}

fn file(exemplar: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/exemplars/{exemplar}.svg"))
}

fn read(exemplar: &str) -> Exemplar {
    let options = ReadOptions {
        chord_mm: 0.25 * CHORD_MM,
        target_height_mm: Some(HEIGHT_MM),
        limits: Limits::default(),
    };
    Exemplar::read(&file(exemplar), &options).expect("the fixtures can be read")
}

fn slice(region: &Region) -> Catalogue {
    let (region, _) = region.without_specks(CHORD_MM * CHORD_MM);
    let (low, high) = region.bounds_mm().expect("the fixtures have ink");
    let rule = SlicingRule::reeb_for_width(high.x - low.x);
    let slicing = Slicing::new(&region, &ReebGraph::new(&region), rule, &Tolerances::default());
    Catalogue::new(&region, &slicing.expect("the fixtures can be cut").cuts, &CostWeights::default())
}

fn catalogue(exemplar: &str) -> Catalogue {
    slice(read(exemplar).region())
}

fn solve(catalogue: &Catalogue, shape: Shape, length_mm: f64) -> Plan {
    let goal = Goal { components: Some(1.into()), holes: None, closed_pattern: shape == Shape::Ring };
    let options = PlanOptions {
        shape,
        length_mm,
        height_mm: HEIGHT_MM,
        goal,
        weights: CostWeights::default(),
        seed: None,
        seed_spread: SEED_SPREAD,
        variety: None,
        memory_limit: DEFAULT_MEMORY_LIMIT,
        effort: None,
    };
    plan(catalogue, &options).expect("the fixtures make bands of one component")
}

fn fit(catalogue: &Catalogue, plan: &Plan, length_mm: f64) -> Outline {
    let options = FitOptions {
        length_mm,
        height_mm: HEIGHT_MM,
        is_ring: true,
        chord_mm: 0.125 * CHORD_MM,
        stitch: StitchMethod::default(),
        sides: Sides::Free,
    };
    Outline::new(catalogue, &plan.sequence, &options).expect("a plan is a run of the catalogue")
}

/// The outline along a circle, on the grid that the files hold.
fn map(outline: &Outline, length_mm: f64) -> Region {
    let circle = PlanarCurve::circle(length_mm / PI).expect("the lengths are in range");
    let map = BandMap::new(circle, -HEIGHT_MM / 2.0, HEIGHT_MM / 2.0).expect("the bands do not fold");
    let grid = Grid::for_extent(length_mm).expect("the lengths are in range");
    let middle = DVec2::splat(length_mm / 2.0);
    let contours = outline.contours.iter().filter_map(|contour| {
        let points = map.map_contour(&contour.points, contour.winding, 0.125 * CHORD_MM);
        let snapped = points.iter().map(|&p| grid.snap(p + middle));
        Contour::new(snapped.collect::<Result<_, _>>().expect("the bands lie on the grid"))
    });
    let region = Region::from_contours(grid, contours.collect()).expect("contours do not touch");
    snapped_to_f32(&region).expect("a file can hold the bands")
}

fn builder(case: Case) -> BandBuilder {
    let along = CurveSpec::Circle { diameter_mm: case.length_mm / PI };
    BandBuilder::new(file(case.exemplar), along).width_mm(HEIGHT_MM).components(1).closed_pattern(true)
}

fn band(case: Case) -> Band {
    let job = builder(case).build().expect("the options are in order");
    job.run(&mut |_| {}).expect("the fixtures make bands of one component")
}

#[divan::bench(args = EXEMPLARS, sample_count = 20)]
fn read_svg(bencher: Bencher, exemplar: &str) {
    bencher.bench(|| read(black_box(exemplar)));
}

#[divan::bench(args = EXEMPLARS, sample_count = 20)]
fn slice_exemplar(bencher: Bencher, exemplar: &str) {
    let exemplar = read(exemplar);
    bencher.bench(|| slice(black_box(exemplar.region())));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn solve_open(bencher: Bencher, case: Case) {
    let catalogue = catalogue(case.exemplar);
    bencher.bench(|| solve(black_box(&catalogue), Shape::Open, case.length_mm));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn solve_ring(bencher: Bencher, case: Case) {
    let catalogue = catalogue(case.exemplar);
    bencher.bench(|| solve(black_box(&catalogue), Shape::Ring, case.length_mm));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn fit_outline(bencher: Bencher, case: Case) {
    let catalogue = catalogue(case.exemplar);
    let plan = solve(&catalogue, Shape::Ring, case.length_mm);
    bencher.bench(|| fit(black_box(&catalogue), &plan, case.length_mm));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn map_and_snap(bencher: Bencher, case: Case) {
    let catalogue = catalogue(case.exemplar);
    let plan = solve(&catalogue, Shape::Ring, case.length_mm);
    let outline = fit(&catalogue, &plan, case.length_mm);
    bencher.bench(|| map(black_box(&outline), case.length_mm));
}

/// Rings in rows, of 100,000 vertices together: each an island with a hole, waved so that nothing is quite regular.
fn field() -> Region {
    const COLUMNS: usize = 25;
    const ROWS: usize = 20;
    const VERTICES: usize = 100;
    let grid = Grid::for_extent(256.0).expect("the extent is in range");
    let paths = (0..COLUMNS * ROWS * 2).map(|i| {
        let (ring, is_hole) = (i / 2, i % 2 == 1);
        let middle = DVec2::new((ring % COLUMNS) as f64, (ring / COLUMNS) as f64) * 10.0 + 5.0;
        let radius = if is_hole { 2.5 } else { 4.0 };
        let at = |k: usize| {
            let turn = 2.0 * PI * k as f64 / VERTICES as f64;
            let wave = 1.0 + 0.1 * (5.0 * turn + ring as f64).sin();
            let p = middle + DVec2::from_angle(turn) * radius * wave;
            grid.snap(p).expect("the field lies on the grid")
        };
        (0..VERTICES).map(at).collect::<Vec<GridPoint>>()
    });
    Region::fill(grid, &paths.collect::<Vec<_>>(), FillRule::EvenOdd)
}

/// Bridges of 100,000 vertices: 499 struts that make one component, and 500 slits more that leave no hole.
#[divan::bench(args = [500, 0], sample_count = 3)]
fn bridge_to_one_component_and_so_many_holes(bencher: Bencher, holes: usize) {
    let field = field();
    let wanted = Counts { components: 1, holes };
    let options = BridgeOptions {
        width_mm: 0.8,
        min_feature_mm: 0.4,
        min_gap_mm: 0.2,
        chord_mm: CHORD_MM,
        closed_around: None,
        within: None,
    };
    bencher.bench(|| bridge(black_box(&field), wanted, &options).expect("there is room for every bridge"));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn write_svg(bencher: Bencher, case: Case) {
    let band = band(case);
    bencher.bench(|| black_box(&band).svg().expect("the bands can be drawn"));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn extrude_to_stl(bencher: Bencher, case: Case) {
    let band = band(case);
    bencher.bench(|| black_box(&band).stl().expect("the bands are solids"));
}

/// A disc with a wavy edge of a hundred thousand vertices, on the grid of the files.
fn wavy_disc() -> Region {
    const VERTICES: u32 = 100_000;
    let grid = Grid::for_extent(200.0).expect("the disc is in range");
    let point = |i: u32| {
        let angle = f64::from(i) / f64::from(VERTICES) * 2.0 * PI;
        let radius = 80.0 + 5.0 * (60.0 * angle).sin();
        grid.snap(DVec2::splat(100.0) + DVec2::from_angle(angle) * radius).expect("the disc is on the grid")
    };
    let disc = Region::fill(grid, &[(0..VERTICES).map(point).collect()], FillRule::NonZero);
    snapped_to_f32(&disc).expect("a file can hold the disc")
}

/// From an outline of a hundred thousand vertices to the STL file.
#[divan::bench(sample_count = 20)]
fn outline_to_stl(bencher: Bencher) {
    let disc = wavy_disc();
    let folder = tempfile::tempdir().expect("a folder for the file");
    bencher.bench(|| {
        let solid = extrude(black_box(&disc), 2.0).expect("the disc is a solid");
        std::fs::write(folder.path().join("disc.stl"), export::stl(&solid, "").expect("it fits the format"))
    });
}

/// Of that, what writing the file takes.
#[divan::bench(sample_count = 20)]
fn outline_to_stl_bytes(bencher: Bencher) {
    let solid = extrude(&wavy_disc(), 2.0).expect("the disc is a solid");
    let folder = tempfile::tempdir().expect("a folder for the file");
    bencher.bench(|| {
        let bytes = export::stl(black_box(&solid), "").expect("it fits the format");
        std::fs::write(folder.path().join("disc.stl"), bytes)
    });
}

#[divan::bench(args = cases(), sample_count = 10)]
fn verify_svg(bencher: Bencher, case: Case) {
    let drawing = band(case).svg().expect("the bands can be drawn").text;
    let chord_mm = CHORD_MM / 4.0;
    bencher.bench(|| verify::read_svg(black_box(drawing.as_bytes()), chord_mm).expect("it is an SVG"));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn verify_stl(bencher: Bencher, case: Case) {
    let solid = band(case).stl().expect("the bands are solids");
    bencher.bench(|| verify::read_stl(black_box(&solid)).expect("it is an STL"));
}

#[divan::bench(args = cases(), sample_count = 10)]
fn whole_job(bencher: Bencher, case: Case) {
    let folder = tempfile::tempdir().expect("a folder for the files");
    let outputs = ["band.svg", "band.stl"]
        .map(|name| Output::file(folder.path().join(name)).expect("the names say their formats"));
    bencher.bench(|| band(black_box(case)).write(&outputs, None, &mut |_| {}).expect("the bands verify"));
}
