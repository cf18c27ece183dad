//! Several bands of one job and their contact sheet, written together or not at all.

use super::band::Band;
use super::error::JobError;
use super::flat::name;
use super::output::{Output, Pending, Target, persist};
use super::report::BandReport;
use super::stage::Stage;
use crate::export::{Shown, contact_sheet};

/// The longer side of a contact sheet in pixels: many bands share it.
const SHEET_PIXELS: u32 = 2400;

/// Writes `bands` as [`Band::write`] writes one, with the number of each, from 1, in the names of its files (see
/// [`Target::numbered`]), and beside the first file a contact sheet of them all, if the job has one (see
/// [`Target::contact_sheet`]). Files get their names when those of all bands have passed.
///
/// # Errors
/// As [`Band::write`]; then no band has a file. [`JobError::Option`] also for several bands on standard output.
pub fn write_numbered(
    bands: &[Band],
    outputs: &[Output],
    report_file: Option<&Target>,
    progress: &mut dyn FnMut(Stage),
) -> Result<Vec<BandReport>, JobError> {
    let targets = outputs.iter().map(Output::target).chain(report_file);
    if bands.len() > 1 && targets.into_iter().any(|target| *target == Target::Stdout) {
        return Err(JobError::Option {
            option: "--output",
            found: "several bands do not fit on standard output".to_owned(),
            wanted: "give it a name".to_owned(),
        });
    }
    let mut reports = Vec::with_capacity(bands.len());
    let mut pending = Vec::new();
    for (number, band) in (1..).zip(bands) {
        let outputs: Vec<Output> = outputs.iter().map(|output| output.numbered(number)).collect();
        let report_file = report_file.map(|target| target.numbered(number));
        band.job.check_outputs(&outputs, report_file.as_ref())?;
        let (report, files) = band.deliver(&outputs, progress)?;
        pending.extend(files);
        reports.push((report, report_file));
    }
    if let Some(target) = bands.first().and_then(|band| band.job.contact_sheet(outputs)) {
        progress(Stage::Png);
        pending.push(Pending::new(&target, sheet(bands)?)?);
        let file = name(&target).display().to_string();
        reports.iter_mut().for_each(|(report, _)| report.contact_sheet = Some(file.clone()));
    }
    let told = reports.iter().filter_map(|(report, file)| Some((file.as_ref()?, report.to_json())));
    persist(pending, told.collect::<Vec<_>>())?;
    Ok(reports.into_iter().map(|(report, _)| report).collect())
}

/// The contact sheet.
fn sheet(bands: &[Band]) -> Result<Vec<u8>, JobError> {
    let numbers: Vec<String> = (1..=bands.len()).map(|number| format!("{number:02}")).collect();
    let shown = |(band, number)| {
        let band: &Band = band;
        let bridges = band.report.bridges.as_ref().map_or(&[][..], |laid| &laid.bridges);
        Shown { number, region: band.region(), bridges }
    };
    let shown: Vec<Shown<'_>> = bands.iter().zip(numbers.iter().map(String::as_str)).map(shown).collect();
    Ok(contact_sheet(&shown, SHEET_PIXELS)?)
}
