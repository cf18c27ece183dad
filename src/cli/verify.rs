//! `openwork verify`: what a file has, held against what was asked for.

use std::path::Path;
use std::process::ExitCode;

use super::args::VerifyArguments;
use super::run::{CliError, print, print_json, tolerances};
use crate::job::{JobError, recut};
use crate::verify::{self, CertificateReport, Counted, Expected, Tiling};

pub(super) fn run(arguments: &VerifyArguments) -> Result<ExitCode, CliError> {
    let file = arguments.file.display().to_string();
    let tolerances = tolerances(&arguments.tolerances)?;
    let expected = Expected {
        components: arguments.components.between(),
        holes: arguments.holes.between(),
        min_feature_mm: tolerances.min_feature_mm(),
        min_gap_mm: tolerances.min_gap_mm(),
    };
    let bytes = read(&arguments.file)?;
    let certificate = match &arguments.certificate {
        Some(path) => Some((path.as_path(), read(path)?)),
        None => None,
    };
    let recut = match (&certificate, &arguments.exemplar) {
        (Some((_, report)), Some(exemplar)) => Some(recut(report, exemplar)?),
        _ => None,
    };
    let replayed = |counted| {
        let replayed = replay(certificate.as_ref(), &bytes, counted)?;
        Ok::<_, CliError>(replayed.map(|mut replayed| {
            recut.clone().into_iter().for_each(|faults| replayed.add_exemplar(faults));
            replayed
        }))
    };
    let unjudged = |error| CliError::Unjudged { file: file.clone(), error };
    let extension = arguments.file.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let checked = match extension.as_str() {
        "dxf" | "svg" if arguments.tiles && (extension == "dxf" || arguments.cut_lines) => {
            return Err(only_drawings("--tiles", "tiles are joined", "--tiles"));
        }
        "dxf" => {
            let report = verify::read_dxf(&bytes, tolerances.chord_mm() / 4.0).map_err(unjudged)?;
            print_verified(arguments, &report, None, replayed(Counted::Cut(&report, "dxf"))?)?;
            report.check(&expected)
        }
        "svg" if arguments.cut_lines || verify::has_cut_lines(&bytes) => {
            let report = verify::read_cut_svg(&bytes, tolerances.chord_mm() / 4.0).map_err(unjudged)?;
            print_verified(arguments, &report, None, replayed(Counted::Cut(&report, "svg"))?)?;
            report.check(&expected)
        }
        "svg" => {
            let report = verify::read_svg(&bytes, tolerances.chord_mm() / 4.0).map_err(unjudged)?;
            let tiling = arguments.tiles.then(|| verify::tiling(&report.region)).transpose();
            let shown = tiling.as_ref().ok().copied().flatten();
            print_verified(arguments, &report, shown, replayed(Counted::Svg(&report))?)?;
            tiling.map_err(|fault| CliError::Untiled { file: file.clone(), fault })?;
            report.check(&expected)
        }
        "stl" | "3mf" | "obj" if expected.min_feature_mm > 0.0 || expected.min_gap_mm > 0.0 => {
            return Err(only_drawings("--min-feature", "widths are measured", "--min-feature and --min-gap"));
        }
        "stl" | "3mf" | "obj" if arguments.tiles => {
            return Err(only_drawings("--tiles", "tiles are joined", "--tiles"));
        }
        "stl" | "3mf" | "obj" => {
            let read = match extension.as_str() {
                "3mf" => verify::read_threemf(&bytes),
                "obj" => verify::read_obj(&bytes),
                _ => verify::read_stl(&bytes),
            };
            let report = read.map_err(unjudged)?;
            let counted = Counted::Mesh { format: &extension, report: &report };
            print_verified(arguments, &report, None, replayed(counted)?)?;
            report.check(&expected)
        }
        _ => return Err(CliError::UnknownKind { file }),
    };
    checked.map_err(|mismatch| CliError::Mismatch { file: file.clone(), mismatch })?;
    Ok(ExitCode::SUCCESS)
}

fn only_drawings(option: &'static str, what: &str, leave_out: &str) -> CliError {
    CliError::Job(JobError::Option {
        option,
        found: format!("{what} on drawings, not on solids or cut lines"),
        wanted: format!("check the SVG of the same part, or leave out {leave_out}"),
    })
}

fn read(path: &Path) -> Result<Vec<u8>, CliError> {
    let file = path.display().to_string();
    std::fs::read(path).map_err(|error| CliError::Unreadable { file, error })
}

/// Replays the certificate, if there is one.
fn replay(
    certificate: Option<&(&Path, Vec<u8>)>,
    file: &[u8],
    counted: Counted<'_>,
) -> Result<Option<CertificateReport>, CliError> {
    let replayed = certificate.map(|(path, report)| {
        let name = path.display().to_string();
        verify::replay_certificate(report, file, counted)
            .map_err(|error| CliError::Uncertified { file: name, error })
    });
    replayed.transpose()
}

/// What was found in a file, what its copies make, and what its certificate came to.
#[derive(serde::Serialize)]
struct Verified<'a, R> {
    #[serde(flatten)]
    file: &'a R,
    #[serde(skip_serializing_if = "Option::is_none")]
    tiling: Option<Tiling>,
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<&'a CertificateReport>,
}

/// Prints what was found.
///
/// # Errors
/// [`CliError::Refuted`] when the certificate does not hold, after that was printed.
fn print_verified<R: serde::Serialize + std::fmt::Display>(
    arguments: &VerifyArguments,
    file: &R,
    tiling: Option<Tiling>,
    certificate: Option<CertificateReport>,
) -> Result<(), CliError> {
    if arguments.json {
        print_json(&Verified { file, tiling, certificate: certificate.as_ref() })?;
    } else {
        print(&format!("{file}\n"))?;
        if let Some(tiling) = tiling {
            print(&format!("{tiling}\n"))?;
        }
    }
    match (certificate, &arguments.certificate) {
        (Some(report), Some(path)) if !report.holds => {
            Err(CliError::Refuted { file: path.display().to_string(), report: Box::new(report) })
        }
        (Some(report), _) if !arguments.json => print(&format!("{report}\n")),
        _ => Ok(()),
    }
}
