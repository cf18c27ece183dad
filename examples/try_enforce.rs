use openwork::{exemplar::*, export, fabricate::*, verify};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let (file, h, f, g): (&str, f64, f64, f64) =
        (&a[1], a[2].parse().unwrap(), a[3].parse().unwrap(), a[4].parse().unwrap());
    let o =
        ReadOptions { chord_mm: 0.005, target_height_mm: (h > 0.0).then_some(h), limits: Limits::default() };
    let e = Exemplar::read(std::path::Path::new(file), &o).unwrap();
    let r = e.region().clone();
    println!(
        "{:?} {} vertices, area {:.2} endures {} {}",
        Counts::of(&r),
        r.vertices(),
        r.area_mm2(),
        verify::endures_erosion(&r, f / 2., 0.0025),
        verify::endures_dilation(&r, g / 2., 0.0025)
    );
    let t = std::time::Instant::now();
    std::fs::write(format!("{}-before.png", a[5]), export::png(&r, 1600).unwrap()).unwrap();
    match enforce(&r, &EnforceOptions { min_feature_mm: f, min_gap_mm: g, chord_mm: 0.01 }) {
        Ok(x) => {
            println!(
                "{:.2?} added {:.3} removed {:.3} changes {} now {:?} {} vertices endures {} {}",
                t.elapsed(),
                x.added_mm2,
                x.removed_mm2,
                x.changes.len(),
                Counts::of(&x.region),
                x.region.vertices(),
                verify::endures_erosion(&x.region, f / 2., 0.0025),
                verify::endures_dilation(&x.region, g / 2., 0.0025)
            );
            std::fs::write(format!("{}-after.png", a[5]), export::png(&x.region, 1600).unwrap()).unwrap();
        }
        Err(e) => println!("{:.2?} {e}", t.elapsed()),
    }
}
