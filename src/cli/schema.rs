//! The JSON schema of every option and of every report, made from the definitions themselves.
//!
//! Options are described as the keys of a preset: an object for each command, which allows no other keys. So an editor
//! that knows schemas completes presets and underlines what is misspelt.

use std::any::TypeId;

use clap::{Arg, ArgAction, Command, CommandFactory};
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::args::Arguments;
use super::preset::name_of;
use crate::analysis::Analysis;
use crate::job::{BandReport, ExtrudeReport, FillReport, RectReport, SceneReport, View, Workshop};
use crate::verify::{CertificateReport, CutReport, MeshReport, SvgReport};

/// The schema, as a JSON text.
pub(super) fn schema() -> String {
    let program = Arguments::command();
    let commands = program.get_subcommands().filter(|command| command.get_arguments().any(is_option));
    let options: Map<String, Value> =
        commands.map(|command| (command.get_name().to_owned(), options_of(command))).collect();
    // One for all reports, so that what they share is defined once, at the root that every reference begins at.
    let generator = &mut SchemaGenerator::default();
    let reports = json!({
        "band": report::<BandReport>(generator),
        "rect": report::<RectReport>(generator),
        "fill": report::<FillReport>(generator),
        "extrude": report::<ExtrudeReport>(generator),
        "build": report::<SceneReport>(generator),
        "analyze": report::<Analysis>(generator),
        "verify-svg": report::<SvgReport>(generator),
        "verify-cut-lines": report::<CutReport>(generator),
        "verify-mesh": report::<MeshReport>(generator),
        "verify-certificate": report::<CertificateReport>(generator),
    });
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("Openwork {}: options of each command, and reports", env!("CARGO_PKG_VERSION")),
        "options": options,
        "reports": reports,
        "$defs": generator.take_definitions(true),
    });
    format!("{schema:#}\n")
}

/// What a report is like; what it refers to stays with the generator.
fn report<T: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    T::json_schema(generator).into()
}

/// Names that an option takes, by the word for that in a schema: all of them, or examples where files may add others.
fn names(option: &str) -> Option<(&'static str, Value)> {
    let workshop = Workshop::default();
    match option {
        "view" => Some(("enum", View::ALL.map(View::name).to_vec().into())),
        "process" => Some(("examples", workshop.process_names().collect::<Vec<_>>().into())),
        "material" => Some(("examples", workshop.material_names().collect::<Vec<_>>().into())),
        _ => None,
    }
}

/// Whether an argument says something of what is made, and not of the program.
fn is_option(arg: &Arg) -> bool {
    !matches!(
        arg.get_action(),
        ArgAction::Help | ArgAction::HelpShort | ArgAction::HelpLong | ArgAction::Version
    )
}

fn options_of(command: &Command) -> Value {
    let arguments = || command.get_arguments().filter(|arg| is_option(arg));
    let properties: Map<String, Value> =
        arguments().map(|arg| (name_of(arg).to_owned(), option(arg))).collect();
    json!({
        "description": command.get_about().map(ToString::to_string),
        "type": "object",
        "properties": properties,
        "required": arguments().filter(|arg| arg.is_required_set()).map(name_of).collect::<Vec<_>>(),
        "additionalProperties": false,
    })
}

fn option(arg: &Arg) -> Value {
    let mut schema = Map::new();
    if let Some(help) = arg.get_help() {
        schema.insert("description".into(), help.to_string().into());
    }
    let parser = arg.get_value_parser();
    let is_of = |types: &[TypeId]| types.iter().any(|of| parser.type_id() == *of);
    let whole = [TypeId::of::<u16>(), TypeId::of::<u64>(), TypeId::of::<usize>()];
    let values = arg.get_possible_values();
    let mut value = Map::new();
    match arg.get_action() {
        ArgAction::SetTrue => value.insert("type".into(), "boolean".into()),
        _ if !values.is_empty() => {
            let names: Vec<&str> = values.iter().map(|value| value.get_name()).collect();
            value.insert("enum".into(), names.into())
        }
        _ if is_of(&[TypeId::of::<std::path::PathBuf>(), TypeId::of::<String>(), TypeId::of::<View>()]) => {
            value.insert("type".into(), "string".into())
        }
        // A length is a text with a unit or a number; a size of memory and a count are whole or a text.
        _ if is_of(&whole) => value.insert("type".into(), json!(["integer", "string"])),
        _ => value.insert("type".into(), json!(["number", "string"])),
    };
    if let Some((word, names)) = names(name_of(arg)) {
        value.insert(word.into(), names);
    }
    match arg.get_action() {
        ArgAction::Append => {
            schema.insert("type".into(), "array".into());
            schema.insert("items".into(), value.into());
        }
        _ => schema.extend(value),
    }
    if let [default] = arg.get_default_values() {
        schema.insert("default".into(), default.to_string_lossy().into_owned().into());
    }
    schema.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_of_every_command_is_described() {
        let schema: Value = serde_json::from_str(&schema()).unwrap();
        let band = &schema["options"]["band"];
        assert_eq!(band["properties"]["closed-pattern"]["type"], "boolean");
        assert_eq!(band["properties"]["output"]["type"], "array");
        assert_eq!(band["properties"]["slicing"]["default"], "reeb");
        assert_eq!(band["additionalProperties"], false);
        let required: Vec<&str> =
            band["required"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
        assert!(["exemplar", "along", "output"].iter().all(|name| required.contains(name)), "{required:?}");
        for (command, options) in schema["options"].as_object().unwrap() {
            for (name, option) in options["properties"].as_object().unwrap() {
                assert!(option["description"].is_string(), "{command} {name} has no help");
            }
        }
    }

    /// Every reference in a schema.
    fn references<'a>(schema: &'a Value, found: &mut Vec<&'a str>) {
        match schema {
            Value::Object(object) => {
                found.extend(object.get("$ref").and_then(Value::as_str));
                object.values().for_each(|value| references(value, found));
            }
            Value::Array(array) => array.iter().for_each(|value| references(value, found)),
            _ => {}
        }
    }

    #[test]
    fn every_reference_leads_to_a_definition() {
        let schema: Value = serde_json::from_str(&schema()).unwrap();
        let mut found = Vec::new();
        references(&schema, &mut found);
        assert!(found.len() > 20, "{found:?}");
        for reference in found {
            let pointer = reference.strip_prefix('#').expect("all is in one document");
            assert!(schema.pointer(pointer).is_some_and(Value::is_object), "{reference} leads nowhere");
        }
    }

    #[test]
    fn names_are_told() {
        let schema: Value = serde_json::from_str(&schema()).unwrap();
        let band = &schema["options"]["band"]["properties"];
        assert_eq!(
            (&band["view"]["type"], &band["view"]["enum"]),
            (&json!("string"), &json!(["top", "iso", "front"]))
        );
        let has =
            |option: &str, name: &str| band[option]["examples"].as_array().unwrap().contains(&json!(name));
        assert!(has("process", "fdm-0.4") && has("material", "birch-ply"));
    }

    #[test]
    fn reports_are_described_as_they_are_written() {
        let schema: Value = serde_json::from_str(&schema()).unwrap();
        for report in ["band", "rect", "fill", "extrude"] {
            let properties = &schema["reports"][report]["properties"];
            assert_eq!(properties["components"]["type"], "integer", "{report}");
            assert!(properties["holes"]["description"].is_string(), "{report}");
        }
        let has = |report: &str, field: &str| schema["reports"][report]["properties"][field].is_object();
        assert!(has("analyze", "pieces") && has("verify-cut-lines", "pierces") && has("verify-mesh", "unit"));
    }
}
