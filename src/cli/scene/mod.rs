//! Scene files: TOML that says which parts there are, where they are, what must fuse, and what the whole has to be.
//!
//! `docs/scenes.md` is their manual. Paths are relative to the scene. Excluded: how it is built ([`crate::job::Scene`]).

mod part;
mod table;

use std::path::{Path, PathBuf};

use glam::DVec3;
use toml::de::DeTable;

pub(super) use table::SceneError;
use table::{Entry, Source, Table};

use super::preset::name_of;
use super::run::CliError;
use super::values;
use crate::job::{Axis, Joint, Placement, Repeat, Scene, ScenePart, View};
use crate::verify::Between;

/// Keys of a scene.
const KEYS: [&str; 10] =
    ["title", "shells", "genus", "output", "report", "view", "pixels", "every", "part", "joint"];

/// The longer side of pictures in pixels, when none is asked for.
const PIXELS: u32 = 1600;

/// A scene, and where it says that its files go.
pub(super) struct SceneFile {
    pub(super) scene: Scene,
    /// Paths from the folder of the scene.
    pub(super) outputs: Vec<PathBuf>,
    pub(super) report: Option<PathBuf>,
}

/// Reads a scene file.
pub(super) fn read(file: &Path) -> Result<SceneFile, CliError> {
    let text = std::fs::read_to_string(file)
        .map_err(|error| SceneError::Unreadable { file: file.to_owned(), error })?;
    let parsed = DeTable::parse(&text)
        .map_err(|error| SceneError::Syntax { file: file.to_owned(), error: Box::new(error) })?;
    let top = Table::new(Source { file, text: &text }, "the scene", &parsed);
    top.only(&KEYS)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let (parts, widths_mm) = parts(&top, folder)?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let paths = |entry: Entry<'_>| {
        entry.texts().map(|texts| texts.into_iter().map(|text| folder.join(text)).collect::<Vec<_>>())
    };
    let view = |entry: Entry<'_>| {
        let text = entry.text()?;
        text.parse::<View>().map_err(|error| entry.because("is not right", &error))
    };
    let pixels = |entry: Entry<'_>| entry.count().map(|n| n as u32);
    let scene = Scene {
        title: top.get("title").map_or(Ok(name), |entry| entry.text().map(str::to_owned))?,
        joints: joints(&top, &parts, &widths_mm)?,
        parts,
        shells: top.get("shells").map_or(Ok(None), |entry| wanted(&entry))?,
        genus: top.get("genus").map_or(Ok(None), |entry| wanted(&entry))?,
        view: top.get("view").map_or(Ok(View::Iso), view)?,
        pixels: top.get("pixels").map_or(Ok(PIXELS), pixels)?,
        cache: None,
    };
    Ok(SceneFile {
        scene,
        outputs: top.get("output").map_or(Ok(Vec::new()), paths)?,
        report: top.get("report").map(|entry| entry.text().map(|text| folder.join(text))).transpose()?,
    })
}

/// A number, a range or any.
fn wanted(entry: &Entry<'_>) -> Result<Option<Between>, SceneError> {
    let text = match entry.value.get_ref().as_integer() {
        Some(number) => number.as_str().to_owned(),
        None => entry.text()?.to_owned(),
    };
    let count = values::wanted(&text).map_err(|error| entry.because("is not right", &error))?;
    Ok(count.between())
}

/// The parts in the order of their names, and the narrowest material that each may have.
fn parts(top: &Table<'_>, folder: &Path) -> Result<(Vec<ScenePart>, Vec<f64>), CliError> {
    let every = top.get("every").map(|entry| entry.table("every part".to_owned())).transpose()?;
    let parts = top.get("part").map(|entry| entry.table("the list of parts".to_owned())).transpose()?;
    let tables = parts.iter().flat_map(Table::entries);
    let tables = tables.map(|entry| Ok((entry.key, entry.table(format!("part {}", entry.key))?)));
    let tables: Vec<(&str, Table<'_>)> = tables.collect::<Result<_, SceneError>>()?;
    if tables.is_empty() {
        return Err(top.wrong("has no parts", "write a table for each, as [part.foot]").into());
    }
    if let Some(every) = &every {
        let commands: Vec<_> = part::KINDS
            .into_iter()
            .filter(|kind| tables.iter().any(|(_, table)| table.get(kind).is_some()))
            .map(part::command)
            .collect();
        let known: Vec<&str> = commands.iter().flat_map(part::options).map(name_of).collect();
        every.only(&known)?;
    }
    let mut widths_mm = Vec::new();
    let mut found = Vec::new();
    for (name, table) in tables {
        let made = part::read(&table, every.as_ref(), folder)?;
        widths_mm.push(made.min_feature_mm);
        found.push(ScenePart {
            name: name.to_owned(),
            making: made.making,
            files: made.files,
            placement: table
                .get("place")
                .map_or(Ok(Placement::default()), |entry| placement(&entry, name))?,
            repeat: table.get("repeat").map_or(Ok(Repeat::default()), |entry| repeat(&entry, name))?,
        });
    }
    Ok((found, widths_mm))
}

fn axis(entry: &Entry<'_>) -> Result<Axis, SceneError> {
    let text = entry.text()?;
    let found = Axis::ALL.into_iter().find(|axis| axis.name() == text);
    found.ok_or_else(|| entry.because(&format!("is {text}"), "use \"x\", \"y\" or \"z\""))
}

fn placement(entry: &Entry<'_>, part: &str) -> Result<Placement, SceneError> {
    let table = entry.table(format!("place of part {part}"))?;
    table.only(&["centre", "scale", "mirror", "turn", "move"])?;
    let centre = |entry: Entry<'_>| {
        let letters = entry.text()?;
        let axis = |letter: char| Axis::ALL.into_iter().find(|axis| axis.name().starts_with(letter));
        let axes: Option<Vec<Axis>> = letters.chars().map(axis).collect();
        axes.ok_or_else(|| {
            entry.because(&format!("is {letters}"), "use letters of axes, as \"xy\" or \"xyz\"")
        })
    };
    let scale = |entry: Entry<'_>| match entry.number()? {
        factor if (1e-3..=1e3).contains(&factor) => Ok(factor),
        factor => Err(entry.because(&format!("is {factor}"), "use a factor from 0.001 to 1000")),
    };
    Ok(Placement {
        centre: table.get("centre").map_or(Ok(Vec::new()), centre)?,
        scale: table.get("scale").map_or(Ok(1.0), scale)?,
        mirror: table.get("mirror").map(|entry| axis(&entry)).transpose()?,
        turn_deg: table.get("turn").map_or(Ok(DVec3::ZERO), |entry| entry.numbers())?,
        move_mm: table.get("move").map_or(Ok(DVec3::ZERO), |entry| entry.lengths())?,
    })
}

fn repeat(entry: &Entry<'_>, part: &str) -> Result<Repeat, SceneError> {
    // A number alone is so many copies all around the upright axis.
    if entry.value.get_ref().as_integer().is_some() {
        let times = entry.count()?;
        return Ok(Repeat {
            times,
            about: Some(Axis::Z),
            turn_deg: 360.0 / times as f64,
            ..Repeat::default()
        });
    }
    let table = entry.table(format!("repeat of part {part}"))?;
    table.only(&["times", "about", "turn", "through", "step", "mirror"])?;
    let times = table.get("times").map_or(Ok(1), |entry| entry.count())?;
    let about = table.get("about").map(|entry| axis(&entry)).transpose()?;
    let turn = table.get("turn").map(|entry| Ok((entry.number()?, entry))).transpose()?;
    if let Some((_, turn)) = turn.as_ref().filter(|_| about.is_none()) {
        return Err(turn.because("needs an axis", "say about = \"z\""));
    }
    let step_mm = table.get("step").map_or(Ok(DVec3::ZERO), |entry| entry.lengths())?;
    let mirror = table.get("mirror").map(|entry| axis(&entry)).transpose()?;
    if times > 1 && about.is_none() && step_mm == DVec3::ZERO {
        return Err(table.wrong("puts all copies in one place", "say about = \"z\", or step = [10, 0, 0]"));
    }
    let turn_deg = turn.map_or(360.0 / times as f64, |(turn_deg, _)| turn_deg);
    let through_mm = table.get("through").map_or(Ok(DVec3::ZERO), |entry| entry.lengths())?;
    Ok(Repeat { times, about, turn_deg, through_mm, step_mm, mirror })
}

fn joints(top: &Table<'_>, parts: &[ScenePart], widths_mm: &[f64]) -> Result<Vec<Joint>, SceneError> {
    let Some(list) = top.get("joint") else { return Ok(Vec::new()) };
    let names = || parts.iter().map(|part| part.name.as_str());
    list.tables("joint")?
        .iter()
        .map(|table| {
            table.only(&["between", "neighbours", "width"])?;
            let entry = match (table.get("between"), table.get("neighbours")) {
                (Some(entry), None) | (None, Some(entry)) => entry,
                _ => {
                    return Err(
                        table.wrong("joins nothing", "say between = [\"a\", \"b\"], or neighbours = \"a\"")
                    );
                }
            };
            let found = entry.texts()?;
            if let Some(name) = found.iter().find(|name| !names().any(|known| known == **name)) {
                let known: Vec<&str> = names().collect();
                return Err(
                    entry.because(&format!("names {name}"), &format!("the parts are {}", known.join(", ")))
                );
            }
            let (first, second) = match (&found[..], entry.key) {
                ([first, second], "between") if first != second => (*first, Some((*second).to_owned())),
                ([first], "neighbours") => (*first, None),
                (_, "between") => {
                    return Err(
                        entry.because("is not two parts", "name two that differ, as [\"arc\", \"foot\"]")
                    );
                }
                _ => return Err(entry.because("is not one part", "name one, as \"arc\"")),
            };
            let repeats =
                |name: &str| parts.iter().find(|part| part.name == name).is_some_and(|p| p.repeat.times > 1);
            if second.is_none() && !repeats(first) {
                return Err(entry.because("is not repeated", "give the part a repeat with several times"));
            }
            // No wider than the narrower of the two has to be.
            let width_of = |name: &str| {
                names().zip(widths_mm).find(|(known, _)| *known == name).map_or(0.0, |(_, w)| *w)
            };
            let least = width_of(first).min(second.as_deref().map_or(f64::INFINITY, width_of));
            let width_mm = table.get("width").map_or(Ok(least), |entry| entry.length())?;
            Ok(Joint { first: first.to_owned(), second, width_mm })
        })
        .collect()
}
