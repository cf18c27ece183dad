//! From a band to its files: every output encoded, read again and counted, and what was found in them told.

use std::borrow::Cow;

use super::band::Band;
use super::blind;
use super::certificate::{FileDigest, sha256};
use super::error::JobError;
use super::flat::name;
use super::judged::{Drawn, shown};
use super::laser::Cutting;
use super::making::Quantities;
use super::output::{Format, Output, Pending, Target, persist};
use super::picture::Pictured;
use super::raised::MeshFile;
use super::report::BandReport;
use super::small;
use super::stage::{Clock, Stage};

/// What makes all of a band larger.
const LARGER: &str = "a larger --width";

impl Band {
    /// Encodes every output, reads each again, counts, and gives them their names only if all pass. The report
    /// goes to `report_file` as JSON, if one is named.
    ///
    /// # Errors
    /// [`JobError`] when a file cannot be written or does not pass; then none of them exists under its name.
    pub fn write(
        &self,
        outputs: &[Output],
        report_file: Option<&Target>,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<BandReport, JobError> {
        self.job.check_outputs(outputs, report_file)?;
        let (report, pending) = self.deliver(outputs, progress)?;
        persist(pending, report_file.map(|target| (target, report.to_json())))?;
        Ok(report)
    }

    /// Every output, encoded, read again and counted, on its way to its name; and the report.
    pub(super) fn deliver(
        &self,
        outputs: &[Output],
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(BandReport, Vec<Pending>), JobError> {
        let mut clock = Clock::new(progress);
        let mut report = self.report.clone();
        clock.times.clone_from(&report.made.times);
        // What was not made ahead is made now: the solid knows nothing of the drawing.
        let (drawn, raised) = clock.both(
            |clock| match &self.drawn {
                Some(ahead) => Ok(Cow::Borrowed(ahead)),
                None => self.drawn(clock).map(Cow::Owned),
            },
            |clock| match self.raised.as_ref().filter(|raised| raised.is_for(outputs)) {
                Some(ahead) => Ok(Cow::Borrowed(ahead)),
                None => self.raised(outputs, clock).map(Cow::Owned),
            },
        );
        let drawn = drawn.map_err(|error| match error {
            JobError::Mismatch { mismatch, remedy, .. } => {
                JobError::Mismatch { file: shown(outputs), mismatch, remedy }
            }
            error => error,
        })?;
        let Drawn { drawing, found } = &*drawn;
        let raised = raised?;
        let laser = &self.job.options.laser;
        let mut cutting = match laser.is_needed(outputs) {
            true => Some(clock.time(Stage::CutLines, || self.cutting())?),
            false => None,
        };
        let mut pending = Vec::new();
        // A sign is judged as it is left of its plate, and its pattern is not.
        let narrow_places = match cutting.as_ref().filter(|_| laser.carve) {
            Some(cutting) => clock.time(Stage::Verify, || self.judge(cutting.kept(), outputs))?,
            None => found.narrow_places.clone(),
        };
        let min_feature = narrow_places.ink.first().copied();
        (report.made.min_feature, report.made.min_gap) = (min_feature, narrow_places.gaps.first().copied());
        report.made.narrow_places.clone_from(&narrow_places);
        let mut digests = Vec::new();
        let mut sizes = Vec::new();
        let mut digest = |output: &Output, bytes: &[u8]| {
            let file = name(output.target()).display().to_string();
            digests.push(FileDigest { file, format: output.format().name(), sha256: sha256(bytes) });
        };
        for output in outputs {
            if let Some(cutting) = cutting.as_mut().filter(|_| laser.makes(output.format())) {
                let (item, bytes) =
                    cutting.write(output, &self.job.options.picture, &narrow_places, &mut clock)?;
                sizes.push(bytes.len());
                // A certificate counts the pattern, and not what is left around it.
                if laser.cuts(output.format()) && !laser.carve && self.part.joined.is_none() {
                    digest(output, &bytes);
                }
                pending.push(item);
                continue;
            }
            let item = match output.format() {
                Format::Dxf => unreachable!("a DXF has cut lines"),
                Format::Svg => {
                    report.made.svg_segments = Some([drawing.lines, drawing.cubics]);
                    // A certificate counts what is closed, and not what was cut open.
                    if self.part.joined.is_none() {
                        digest(output, drawing.text.as_bytes());
                    }
                    sizes.push(drawing.text.len());
                    let bytes = drawing.text.as_bytes();
                    clock.time(Stage::Verify, || Pending::unchanged(output.target(), bytes))?
                }
                Format::Stl | Format::Threemf | Format::Obj => {
                    let MeshFile { bytes, found, .. } =
                        raised.file(output.format()).expect("its output asked for it");
                    // A certificate counts the pattern, and not the model that it is on.
                    if self.merged_counts()?.is_none() {
                        digest(output, bytes);
                    }
                    sizes.push(bytes.len());
                    report.made.triangles = Some(found.triangles);
                    report.made.shells = Some(found.shells.len());
                    report.made.genus = Some(found.genus);
                    report.made.volume_mm3 = Some(found.volume_mm3);
                    clock.time(Stage::Verify, || Pending::unchanged(output.target(), bytes))?
                }
                Format::Png => {
                    let bridges = self.report.bridges.as_ref().map_or(&[][..], |b| &b.bridges);
                    let engraved = cutting.as_ref().map(Cutting::engraved_on_part).transpose()?.flatten();
                    let part = Pictured {
                        region: &self.part.region,
                        bridges,
                        seams_mm: &self.part.seams_mm,
                        narrow_mm: &report.made.narrow_places.places_mm(),
                        engraved: engraved.as_ref(),
                    };
                    let picture =
                        clock.time(Stage::Png, || self.job.options.picture.png(&part, raised.solid()))?;
                    digest(output, &picture);
                    sizes.push(picture.len());
                    Pending::new(output.target(), picture)?
                }
            };
            pending.push(item);
        }
        let options = &self.job.options;
        report.made.quantities = Some(match cutting.as_ref().and_then(Cutting::sign) {
            Some(sign) => Quantities::new(sign, options.thickness_mm, None, options.material.as_ref()),
            None => {
                let (region, material) = (&self.part.region, options.material.as_ref());
                Quantities::new(region, options.thickness_mm, raised.volume_mm3(), material)
            }
        });
        report.made.notes.extend_from_slice(&raised.notes);
        let (what, whole) = if laser.carve { ("material", "plate") } else { ("ink", "band") };
        report.made.notes.extend(small::hairline(min_feature, what, whole, LARGER));
        let narrowest_mm = found.min_feature.map(|n| n.width_mm);
        let lost = small::warnings(&self.part.region, &self.job.tolerances, outputs, narrowest_mm, LARGER);
        report.made.notes.extend(lost);
        let can_enforce = self.can_enforce();
        report.made.notes.extend(blind::notes(&narrow_places, &self.kept_tolerances(), can_enforce, LARGER));
        report.made.laser = cutting.map(|cutting| cutting.report);
        report.made.bytes = sizes;
        // What was found, or in space what was found in the solid or follows from the sides of the drawing.
        let counts = self
            .part
            .joined
            .as_ref()
            .map_or([found.components, found.holes], |_| [self.counts.components, self.counts.holes]);
        report.made.certificate.seal(counts, digests);
        [report.components, report.holes] = counts;
        report.made.files = outputs.iter().map(|o| name(o.target()).display().to_string()).collect();
        report.made.times = clock.times;
        Ok((report, pending))
    }
}
