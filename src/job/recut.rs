//! Whether the descriptors of a certificate are those of the exemplar: its pieces are cut out again.
//!
//! The exemplar is read as the job did, cut where the certificate says, and each piece that the certificate lists is
//! compared with the one between the same cuts. Nothing is sliced: whatever led to the cuts, what lies between them is
//! what was joined.
//!
//! Excluded: rectangles, whose pieces are rows of a strip that no file has; and whether a piece was bent without
//! changing how it is connected, for which the counts of the file speak.

use std::path::Path;

use serde_json::Value;

use super::cut::{cleaned, read_options};
use super::error::JobError;
use crate::exemplar::Exemplar;
use crate::pieces::{Catalogue, CostWeights};
use crate::planar::Region;
use crate::reeb::{CrossSections, Cut};
use crate::topology::Descriptor;
use crate::verify::{CertificateFault, CertificatePlace};

/// What a certificate says of the exemplar.
struct Told<'v> {
    sha256: &'v str,
    height_mm: Option<f64>,
    chord_mm: f64,
    pieces: usize,
    cuts: Vec<i64>,
}

/// Where the certificate of `report`, the JSON of a band, says something else of its pieces than the file `exemplar`
/// shows; none when all descriptors are those of the geometry.
///
/// # Errors
/// [`JobError`] when the exemplar cannot be read, or the certificate does not say how it was cut.
pub fn recut(report: &[u8], exemplar: &Path) -> Result<Vec<CertificateFault>, JobError> {
    let report: Value = serde_json::from_slice(report).unwrap_or_default();
    let certificate = &report["certificate"];
    let told = Told::new(&certificate["source"]).ok_or_else(|| JobError::Option {
        option: "--exemplar",
        found: "the report does not say how its exemplar was cut, as none of a rectangle does".to_owned(),
        wanted: "give the report of a band, or leave out --exemplar".to_owned(),
    })?;
    let fault = |place, fault: String| CertificateFault { place, fault };
    let of_exemplar = |text| Ok(vec![fault(CertificatePlace::Exemplar, text)]);
    let found = Exemplar::read(exemplar, &read_options(told.chord_mm, told.height_mm))?;
    if found.sha256() != told.sha256 {
        let (found, told) = (found.sha256(), told.sha256);
        return of_exemplar(format!("its SHA-256 is {found}; the certificate speaks of {told}"));
    }
    let (region, _) = cleaned(found.region(), told.chord_mm);
    let cuts = match cuts_at(&region, &told.cuts) {
        Ok(cuts) => cuts,
        Err(text) => return of_exemplar(text),
    };
    let catalogue =
        Catalogue::with_mirrored(&region, &cuts, &CostWeights { successors: 1, ..CostWeights::default() });
    if catalogue.originals() != told.pieces {
        let (found, told) = (catalogue.originals(), told.pieces);
        return of_exemplar(format!("the cuts make {found} piece(s) of it; the certificate says {told}"));
    }
    let listed = certificate["pieces"].as_array().into_iter().flatten();
    let faults = listed.filter_map(|listed| {
        let piece = listed["piece"].as_i64().unwrap_or(-1);
        let found = usize::try_from(piece).ok().and_then(|piece| catalogue.descriptors().get(piece));
        let text = match found {
            None => Some(format!("the exemplar has {} pieces, each of them mirrored too", told.pieces)),
            Some(found) => difference(found, listed),
        };
        text.map(|text| fault(CertificatePlace::Piece { piece }, text))
    });
    Ok(faults.collect())
}

impl<'v> Told<'v> {
    fn new(source: &'v Value) -> Option<Self> {
        let number = |value: &Value| value.as_str()?.parse::<f64>().ok().filter(|mm| *mm > 0.0);
        let height = &source["height_mm"];
        Some(Self {
            sha256: source["sha256"].as_str()?,
            height_mm: if height.is_null() { None } else { Some(number(height)?) },
            chord_mm: number(&source["chord_mm"])?,
            pieces: usize::try_from(source["pieces"].as_u64()?).ok()?,
            cuts: source["cuts"].as_array()?.iter().map(Value::as_i64).collect::<Option<_>>()?,
        })
    }
}

/// The cuts of `region` at `xs`; why there can be none there otherwise.
fn cuts_at(region: &Region, xs: &[i64]) -> Result<Vec<Cut>, String> {
    let sections = CrossSections::new(region);
    if !xs.is_sorted_by(|a, b| a < b) {
        return Err("the cuts of the certificate are not from left to right".to_owned());
    }
    // Far beyond the ink no sum overflows either.
    let is_wrong = |&&x: &&i64| x.unsigned_abs() > 1 << 40 || sections.has_vertex_between(x - 1, x + 1);
    if let Some(x) = xs.iter().find(is_wrong) {
        return Err(format!(
            "the certificate cuts it at {:.4} mm, where nothing is cut",
            region.grid().mm(*x)
        ));
    }
    let crossings = sections.at(xs);
    Ok(crossings.into_iter().zip(xs).map(|(crossings, &x)| Cut { x, crossings }).collect())
}

/// How a listed descriptor differs from that of the geometry.
fn difference(found: &Descriptor, listed: &Value) -> Option<String> {
    let labels = |labels: &[u16]| serde_json::json!(labels);
    let fields = [
        ("labels on the left", labels(found.left()), &listed["left"]),
        ("labels on the right", labels(found.right()), &listed["right"]),
        ("closed components", found.closed().into(), &listed["closed"]),
        ("an Euler characteristic of", found.euler().into(), &listed["euler"]),
    ];
    let differs = fields.iter().find(|(_, found, listed)| found != *listed);
    differs.map(|(what, found, listed)| {
        format!("the exemplar has {what} {found} there; the certificate says {listed}")
    })
}
