//! The meshes of a 3MF package, as its build puts them together.
//!
//! A 3MF is a zip archive with an XML model: objects that are meshes, or are put together from other objects,
//! and a build whose items say which objects are made and where. All items are read into one list of facets
//! in millimetres, whatever the unit of the model. Coordinates are rounded to 32-bit floats as slicers do;
//! those of a model in millimetres that moves nothing are the nearest to what is written.
//! Excluded, by an error that says so: models that need an extension to be understood. Materials, colours and
//! metadata are passed over.

use std::io::{Cursor, Read};

use glam::{DAffine3, DVec3};
use roxmltree::{Document, Node};
use rustc_hash::FxHashMap;
use zip::ZipArchive;
use zip::result::ZipError;

use super::error::VerifyError;
use super::shells::{Facet, MeshReport, survey};

/// The largest package, and the largest part in one, that are read, in bytes.
const MAX_BYTES: usize = 1 << 28;
/// The most facets that a build may come to: components may repeat each other many times over.
const MAX_FACETS: usize = 20_000_000;
/// The relationship that leads to the model.
const MODEL_RELATIONSHIP: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const RELATIONSHIPS: &str = "_rels/.rels";
/// The units of a model, in millimetres.
const UNITS: [(&str, f64); 6] = [
    ("micron", 0.001),
    ("millimeter", 1.0),
    ("centimeter", 10.0),
    ("inch", 25.4),
    ("foot", 304.8),
    ("meter", 1000.0),
];

/// Reads a 3MF and counts the shells of all that it builds, and their genus.
///
/// # Errors
/// [`VerifyError`] when the package, its model or a mesh cannot be read, with the line of the model. What is
/// wrong with the solid itself is a fault of the report.
pub fn read_threemf(bytes: &[u8]) -> Result<MeshReport, VerifyError> {
    let (facets, unit) = facets(bytes)?;
    Ok(MeshReport { unit, ..survey(&facets) })
}

/// The facets of all that a 3MF builds, at least one, and the unit that it names.
pub(super) fn facets(bytes: &[u8]) -> Result<(Vec<Facet>, Option<&'static str>), VerifyError> {
    if bytes.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(archive_error)?;
    let relationships = part(&mut archive, RELATIONSHIPS)?;
    let path = model_path(&relationships)?;
    let text = part(&mut archive, &path)?;
    let (facets, unit) = Model::facets_of(&text)?;
    match facets.is_empty() {
        true => Err(VerifyError::NoFacets),
        false => Ok((facets, unit)),
    }
}

fn archive_error(error: ZipError) -> VerifyError {
    VerifyError::Archive { message: error.to_string() }
}

/// The text of a part of the package.
fn part(archive: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<String, VerifyError> {
    let file = match archive.by_name(name) {
        Ok(file) => file,
        Err(ZipError::FileNotFound) => return Err(VerifyError::NoModel { part: name.to_owned() }),
        Err(error) => return Err(archive_error(error)),
    };
    let mut text = Vec::new();
    let limit = MAX_BYTES as u64;
    let read = file.take(limit + 1).read_to_end(&mut text);
    read.map_err(|e| VerifyError::Archive { message: format!("{name}: {e}") })?;
    if text.len() > MAX_BYTES {
        return Err(VerifyError::TooLarge { bytes: text.len(), limit: MAX_BYTES });
    }
    String::from_utf8(text).map_err(|e| VerifyError::NotText { offset: e.utf8_error().valid_up_to() })
}

fn parse(text: &str) -> Result<Document<'_>, VerifyError> {
    Document::parse(text).map_err(|e| VerifyError::Xml { message: e.to_string() })
}

/// The name of the model among the parts.
fn model_path(relationships: &str) -> Result<String, VerifyError> {
    let document = parse(relationships)?;
    let model = document.descendants().find(|node| node.attribute("Type") == Some(MODEL_RELATIONSHIP));
    let target = model.and_then(|node| node.attribute("Target"));
    let target = target.ok_or_else(|| VerifyError::NoModel {
        part: format!("relationship to a 3D model in {RELATIONSHIPS}"),
    })?;
    Ok(target.trim_start_matches('/').to_owned())
}

/// A mesh or what it is put together from.
enum Object {
    Mesh { vertices: Vec<Vertex>, triangles: Vec<[usize; 3]> },
    Components(Vec<Placed>),
}

/// A corner as it is written.
#[derive(Clone, Copy)]
struct Vertex {
    /// Each number as an `f64`, for what is scaled or moved.
    exact: DVec3,
    /// The nearest `f32` to each, for what is not.
    nearest: [f32; 3],
}

/// An object at its place.
struct Placed {
    object: usize,
    place: Option<DAffine3>,
}

/// The objects of a model, in the order of the file.
struct Model<'a, 'input> {
    document: &'a Document<'input>,
    numbers: FxHashMap<&'a str, usize>,
    objects: Vec<Object>,
}

impl<'a, 'input> Model<'a, 'input> {
    /// The facets in millimetres, and the unit that the model says it is in.
    fn facets_of(text: &str) -> Result<(Vec<Facet>, Option<&'static str>), VerifyError> {
        let document = parse(text)?;
        let root = document.root_element();
        let mut model = Model { document: &document, numbers: FxHashMap::default(), objects: Vec::new() };
        if root.tag_name().name() != "model" {
            return Err(
                model.error(root, format!("the root is <{}>; <model> is wanted", root.tag_name().name()))
            );
        }
        if let Some(needed) = root.attribute("requiredextensions").filter(|list| !list.trim().is_empty()) {
            let message = format!(
                "the model needs the extension(s) {needed:?}, which are not read; export a plain 3MF"
            );
            return Err(model.error(root, message));
        }
        let unit = model.unit(root)?;
        // What says nothing is in millimetres (3MF core specification, 3.4).
        let unit_mm = unit.map_or(1.0, |(_, unit_mm)| unit_mm);
        let scale = (unit_mm != 1.0).then(|| DAffine3::from_scale(DVec3::splat(unit_mm)));
        for object in named(root, "resources").flat_map(|node| named(node, "object")) {
            model.add(object)?;
        }
        let mut facets = Vec::new();
        for item in named(root, "build").flat_map(|node| named(node, "item")) {
            let placed = model.placed(item)?;
            model.gather(item, &placed, scale, &mut facets)?;
        }
        Ok((facets, unit.map(|(name, _)| name)))
    }

    fn error(&self, at: Node<'_, '_>, message: String) -> VerifyError {
        let line = self.document.text_pos_at(at.range().start).row;
        VerifyError::Mesh { kind: "3MF model", line, message }
    }

    /// The unit that the model names, and how many millimetres it is.
    fn unit(&self, root: Node<'_, '_>) -> Result<Option<(&'static str, f64)>, VerifyError> {
        let Some(name) = root.attribute("unit") else { return Ok(None) };
        let known = UNITS.into_iter().find(|(known, _)| *known == name);
        let unknown = || self.error(root, format!("the unit {name:?} is none that a 3MF can have"));
        known.map(Some).ok_or_else(unknown)
    }

    fn add(&mut self, node: Node<'a, 'input>) -> Result<(), VerifyError> {
        let id = self.text(node, "id")?;
        let object = match (named(node, "mesh").next(), named(node, "components").next()) {
            (Some(mesh), None) => self.mesh(mesh)?,
            (None, Some(components)) => {
                let placed = named(components, "component").map(|component| self.placed(component));
                Object::Components(placed.collect::<Result<_, _>>()?)
            }
            _ => return Err(self.error(node, format!("object {id} is neither a mesh nor components"))),
        };
        // An object may only use those before it, so that none can hold itself.
        if self.numbers.insert(id, self.objects.len()).is_some() {
            return Err(self.error(node, format!("a second object {id}")));
        }
        self.objects.push(object);
        Ok(())
    }

    fn mesh(&self, node: Node<'a, 'input>) -> Result<Object, VerifyError> {
        let of = |list, element| named(node, list).flat_map(move |node| named(node, element));
        let vertices = of("vertices", "vertex").map(|node| self.vertex(node));
        let vertices = vertices.collect::<Result<Vec<_>, _>>()?;
        let triangles = of("triangles", "triangle").map(|node| {
            let mut corners = [0; 3];
            for (corner, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
                let text = self.text(node, name)?;
                *corner = text.parse().ok().filter(|&v: &usize| v < vertices.len()).ok_or_else(|| {
                    let known = vertices.len();
                    self.error(
                        node,
                        format!("{name} is {text}, but the mesh has {known} vertices, from 0 on"),
                    )
                })?;
            }
            Ok(corners)
        });
        let triangles = triangles.collect::<Result<_, _>>()?;
        Ok(Object::Mesh { vertices, triangles })
    }

    fn vertex(&self, node: Node<'_, '_>) -> Result<Vertex, VerifyError> {
        let mut vertex = Vertex { exact: DVec3::ZERO, nearest: [0.0; 3] };
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            let text = node.attribute(name);
            let text = text.ok_or_else(|| self.error(node, format!("a vertex without {name}")))?;
            (vertex.exact[i], vertex.nearest[i]) = (self.number(node, text)?, self.number(node, text)?);
        }
        Ok(vertex)
    }

    /// The object that an item or a component names, at its place.
    fn placed(&self, node: Node<'a, 'input>) -> Result<Placed, VerifyError> {
        let id = self.text(node, "objectid")?;
        let object = *self
            .numbers
            .get(id)
            .ok_or_else(|| self.error(node, format!("object {id} is not defined before it is used")))?;
        let place = node.attribute("transform").map(|text| self.transform(node, text)).transpose()?;
        Ok(Placed { object, place })
    }

    /// Twelve numbers: where the axes go, then where the origin goes.
    fn transform(&self, node: Node<'_, '_>, text: &str) -> Result<DAffine3, VerifyError> {
        let numbers = text.split_whitespace().map(|word| self.number(node, word));
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        let numbers: [f64; 12] = numbers.try_into().map_err(|found: Vec<f64>| {
            self.error(node, format!("a transform of {} numbers, not 12", found.len()))
        })?;
        let place = DAffine3::from_cols_array(&numbers);
        if place.matrix3.determinant() == 0.0 {
            return Err(self.error(node, "a transform that leaves nothing of a solid".to_owned()));
        }
        Ok(place)
    }

    /// Adds the facets of an object at its place in what holds it.
    fn gather(
        &self,
        item: Node<'_, '_>,
        placed: &Placed,
        outer: Option<DAffine3>,
        facets: &mut Vec<Facet>,
    ) -> Result<(), VerifyError> {
        let place = match (outer, placed.place) {
            (Some(outer), Some(inner)) => Some(outer * inner),
            (outer, inner) => outer.or(inner),
        };
        match &self.objects[placed.object] {
            Object::Components(components) => {
                components.iter().try_for_each(|component| self.gather(item, component, place, facets))
            }
            Object::Mesh { vertices, triangles } => {
                if facets.len() + triangles.len() > MAX_FACETS {
                    return Err(self.error(item, format!("more than {MAX_FACETS} triangles are built")));
                }
                let at = |vertex: &Vertex| match place {
                    Some(place) => place.transform_point3(vertex.exact).to_array().map(|x| x as f32),
                    None => vertex.nearest,
                };
                let vertices: Vec<[f32; 3]> = vertices.iter().map(at).collect();
                if vertices.iter().flatten().any(|x| !x.is_finite()) {
                    return Err(self.error(item, "a transform beyond all numbers".to_owned()));
                }
                let is_mirrored = place.is_some_and(|place| place.matrix3.determinant() < 0.0);
                facets.extend(triangles.iter().map(|&[a, b, c]| {
                    let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
                    Facet { normal: [0.0; 3], corners: corners.map(|v| vertices[v]) }
                }));
                Ok(())
            }
        }
    }

    fn text(&self, node: Node<'a, 'input>, name: &str) -> Result<&'a str, VerifyError> {
        node.attribute(name)
            .ok_or_else(|| self.error(node, format!("<{}> has no {name}", node.tag_name().name())))
    }

    fn number<T: std::str::FromStr + Into<f64> + Copy>(
        &self,
        node: Node<'_, '_>,
        text: &str,
    ) -> Result<T, VerifyError> {
        let number: Option<T> = text.trim().parse().ok();
        number
            .filter(|&x| x.into().is_finite())
            .ok_or_else(|| self.error(node, format!("{text:?} is no finite number")))
    }
}

/// The children of `node` with a name, in whatever namespace: only one is in use where no extension is needed.
fn named<'a, 'input: 'a>(node: Node<'a, 'input>, name: &str) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}
