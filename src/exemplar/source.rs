//! From bytes to an XML document whose elements know their line.
//!
//! Only the outer shell of a file is judged here: its size, encoding, well-formedness, root, entities and raw
//! nesting. What the elements mean is the business of [`super::scan`].
//!
//! The SVG library keeps nothing of an element but its id. [`Source::labelled`] therefore gives an id to every
//! element that has none, so that whatever comes out of the library can be named by line.

use std::collections::HashMap;

use roxmltree::{Document, Node, ParsingOptions};

use super::error::{ExemplarFault, Place};
use super::limits::Limits;

pub(super) const SVG_NAMESPACE: &str = "http://www.w3.org/2000/svg";
const XLINK_NAMESPACE: &str = "http://www.w3.org/1999/xlink";
const INKSCAPE_NAMESPACE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// Tags that draw by themselves.
pub(super) const SHAPES: [&str; 7] = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon"];
/// Tags whose ids survive in the SVG library, besides [`SHAPES`].
const LABELLED_GROUPS: [&str; 2] = ["g", "use"];

/// A well-formed SVG document.
pub(super) struct Source<'a> {
    text: &'a str,
    xml: Document<'a>,
    /// The byte at which each line begins.
    line_starts: Vec<usize>,
}

impl<'a> Source<'a> {
    /// The document in `bytes`.
    pub(super) fn parse(bytes: &'a [u8], limits: &Limits) -> Result<Self, ExemplarFault> {
        if bytes.len() > limits.bytes {
            return Err(ExemplarFault::TooManyBytes { limit: limits.bytes });
        }
        if bytes.starts_with(&[0x1f, 0x8b]) {
            return Err(ExemplarFault::Compressed);
        }
        let text = std::str::from_utf8(bytes).map_err(|e| ExemplarFault::NotUtf8 {
            line: 1 + bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count(),
        })?;
        if text.trim_start_matches('\u{feff}').trim().is_empty() {
            return Err(ExemplarFault::Blank);
        }
        // Every element may have a text node before and after it; the exact count comes with the scan.
        let nodes_limit =
            u32::try_from(limits.elements.saturating_mul(3).saturating_add(64)).unwrap_or(u32::MAX);
        let options = ParsingOptions { allow_dtd: true, nodes_limit, ..ParsingOptions::default() };
        let xml = Document::parse_with_options(text, options).map_err(|e| match e {
            roxmltree::Error::NodesLimitReached => ExemplarFault::TooManyElements { limit: limits.elements },
            e => ExemplarFault::NotXml { detail: e.to_string() },
        })?;
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|&(_, b)| b == b'\n').map(|(i, _)| i + 1))
            .collect();
        let source = Self { text, xml, line_starts };
        source.check_shell(limits)?;
        Ok(source)
    }

    fn check_shell(&self, limits: &Limits) -> Result<(), ExemplarFault> {
        let root = self.root();
        if let Some(at) = self.text[..root.range().start].find("<!ENTITY") {
            return Err(ExemplarFault::Entity { line: self.line(at) });
        }
        if svg_tag(root) != Some("svg") {
            return Err(ExemplarFault::NotSvg { root: root.tag_name().name().to_owned() });
        }
        let sheet = |n: &Node| n.pi().is_some_and(|pi| pi.target == "xml-stylesheet");
        if let Some(pi) = self.xml.root().children().find(sheet) {
            let what = "the external style sheet (<?xml-stylesheet?>)".to_owned();
            return Err(ExemplarFault::StyleSheet { what, line: self.line(pi.range().start) });
        }
        self.check_nesting(limits)
    }

    /// Nesting as written, before any recursive code sees the document.
    fn check_nesting(&self, limits: &Limits) -> Result<(), ExemplarFault> {
        let mut node = self.root();
        let mut depth = 1;
        loop {
            if depth > limits.nesting {
                return Err(ExemplarFault::TooDeep { place: self.place(node), limit: limits.nesting });
            }
            if let Some(child) = node.first_element_child() {
                (node, depth) = (child, depth + 1);
                continue;
            }
            while node.next_sibling_element().is_none() {
                match node.parent_element() {
                    Some(parent) => (node, depth) = (parent, depth - 1),
                    None => return Ok(()),
                }
            }
            node = node.next_sibling_element().expect("the loop above ended on one");
        }
    }

    /// The document.
    pub(super) fn xml(&self) -> &Document<'a> {
        &self.xml
    }

    /// The root element.
    pub(super) fn root(&self) -> Node<'_, 'a> {
        self.xml.root_element()
    }

    /// The line of a byte, counted from 1.
    pub(super) fn line(&self, byte: usize) -> usize {
        self.line_starts.partition_point(|&start| start <= byte)
    }

    /// The name of an element for messages.
    pub(super) fn place(&self, node: Node) -> Place {
        Place {
            tag: node.tag_name().name().into(),
            id: node.attribute("id").map(Into::into),
            line: self.line(node.range().start),
        }
    }

    /// The text with an id on every shape, group and `use`, and the element that each id stands for. Of
    /// elements that share an id, the first is meant.
    pub(super) fn labelled(&self) -> (String, Labels) {
        let mut text = String::with_capacity(self.text.len() + self.text.len() / 8);
        let mut labels = HashMap::new();
        let mut copied = 0;
        for node in self.xml.descendants().filter(Node::is_element) {
            let Some(tag) = svg_tag(node) else { continue };
            if !SHAPES.contains(&tag) && !LABELLED_GROUPS.contains(&tag) {
                continue;
            }
            let label = match node.attribute("id") {
                Some(id) if !id.is_empty() => id.to_owned(),
                Some(_) => continue,
                None => {
                    let name_start = node.range().start + 1;
                    let rest = &self.text[name_start..];
                    let name_end = rest.find(|c: char| c.is_ascii_whitespace() || c == '/' || c == '>');
                    let at = name_start + name_end.unwrap_or(rest.len());
                    let label = label_of(node);
                    text.push_str(&self.text[copied..at]);
                    text.push_str(" id=\"");
                    text.push_str(&label);
                    text.push('"');
                    copied = at;
                    label
                }
            };
            labels.entry(label).or_insert(Labelled {
                place: self.place(node),
                is_use: tag == "use",
                is_layer: node.attribute((INKSCAPE_NAMESPACE, "groupmode")) == Some("layer"),
            });
        }
        text.push_str(&self.text[copied..]);
        (text, Labels { labels })
    }
}

fn label_of(node: Node) -> String {
    format!("openwork-element-{}", node.id().get())
}

/// The id under which an element is found in the labelled document.
pub(super) fn label(node: Node) -> String {
    node.attribute("id").map_or_else(|| label_of(node), str::to_owned)
}

/// The elements behind the ids of a labelled document.
pub(super) struct Labels {
    labels: HashMap<String, Labelled>,
}

struct Labelled {
    place: Place,
    is_use: bool,
    is_layer: bool,
}

impl Labels {
    /// The element with this id.
    pub(super) fn place(&self, id: &str) -> Option<&Place> {
        self.labels.get(id).map(|element| &element.place)
    }

    /// Whether the element with this id is a `use`.
    pub(super) fn is_use(&self, id: &str) -> bool {
        self.labels.get(id).is_some_and(|element| element.is_use)
    }

    /// Whether the element with this id is a layer of Inkscape, which sorts a drawing and groups nothing.
    pub(super) fn is_layer(&self, id: &str) -> bool {
        self.labels.get(id).is_some_and(|element| element.is_layer)
    }
}

/// The tag of an element of SVG, which may be in no namespace at all; `None` for other nodes.
pub(super) fn svg_tag<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let name = node.tag_name();
    (node.is_element() && matches!(name.namespace(), None | Some(SVG_NAMESPACE))).then(|| name.name())
}

/// The link of an element: `href`, or `xlink:href` when there is none.
pub(super) fn href<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let plain = node.attributes().find(|a| a.name() == "href" && a.namespace().is_none());
    let xlink = || node.attributes().find(|a| a.name() == "href" && a.namespace() == Some(XLINK_NAMESPACE));
    plain.or_else(xlink).map(|a| a.value())
}
