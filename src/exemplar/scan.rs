//! The walk over the XML that makes sure nothing is left out silently.
//!
//! The scan follows the document as a viewer would: into groups, through `use`, past definitions and what is
//! not displayed. On its way it checks every value ([`super::check`]), refuses what ink cannot represent, and
//! counts the shapes that must come out of the SVG library. What the library kept is compared with that
//! count afterwards, so that an element lost for a reason unknown to the scan is still an error.
//!
//! Out of its sight: the contents of gradients (the library resolves them), and animations and scripts, which
//! change nothing in a file that is read once.

use std::collections::{BTreeMap, HashMap, HashSet};

use roxmltree::{Node, NodeId};
use svgtypes::{FuncIRI, Paint};

use super::check::Checker;
use super::error::{ExemplarFault, Place, shortened};
use super::limits::Limits;
use super::source::{SHAPES, Source, href, label, svg_tag};
use super::style::{Cascade, Declared};

/// What the scan found.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// How many shapes must come out for the element with this label: 1 for a shape, any number for a `use`.
    pub(super) expected: BTreeMap<String, (usize, Place)>,
    /// Things worth telling.
    pub(super) notes: Vec<String>,
}

/// How strictly to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strictness {
    /// Everything visible must be representable.
    Ink,
    /// Only what could exhaust memory or the stack is refused: the caller wants one element of the file.
    Structure,
}

/// Walks over the document.
pub(super) fn scan(source: &Source, limits: &Limits, strictness: Strictness) -> Result<Scan, ExemplarFault> {
    let mut ids = HashMap::new();
    for node in source.xml().descendants() {
        if let Some(id) = node.attribute("id") {
            ids.entry(id).or_insert(node);
        }
    }
    let mut walk = Walk {
        source,
        limits,
        strictness,
        checker: Checker { source, limits },
        cascade: Cascade::new(source)?,
        ids,
        found: Scan::default(),
        elements: 0,
        segments: 0,
        open_uses: Vec::new(),
        referenced: HashSet::new(),
        marker: None,
    };
    let root = source.root();
    walk.note_units(root);
    walk.element(
        root,
        &Context { depth: 1, visible: true, dashed: false, anchor: None, counted: true, used: false },
    )?;
    // A marker is drawn at every vertex: at most so many times does the library copy its elements.
    match walk.marker {
        Some((place, elements)) if walk.segments.saturating_mul(elements) > limits.segments => {
            Err(ExemplarFault::TooManySegments { place, limit: limits.segments })
        }
        _ => Ok(walk.found),
    }
}

/// What an element gets from those around it.
#[derive(Clone)]
struct Context<'a> {
    depth: usize,
    visible: bool,
    dashed: bool,
    /// The outermost `use` around it.
    anchor: Option<Node<'a, 'a>>,
    /// Whether the library reports it as a shape of the drawing: not so in markers and clip paths.
    counted: bool,
    /// Whether a `use` leads right here, which alone makes a symbol drawn.
    used: bool,
}

struct Walk<'a> {
    source: &'a Source<'a>,
    limits: &'a Limits,
    strictness: Strictness,
    checker: Checker<'a>,
    cascade: Cascade<'a>,
    ids: HashMap<&'a str, Node<'a, 'a>>,
    found: Scan,
    elements: usize,
    segments: usize,
    open_uses: Vec<NodeId>,
    /// Markers and clip paths that were looked into.
    referenced: HashSet<NodeId>,
    /// The first marker in use, and the number of elements in all of them.
    marker: Option<(Place, usize)>,
}

impl<'a> Walk<'a> {
    fn unsupported(&self, node: Node, what: impl Into<String>, remedy: &'static str) -> ExemplarFault {
        ExemplarFault::Unsupported { place: self.source.place(node), what: what.into(), remedy }
    }

    fn note_units(&mut self, root: Node) {
        if !root.has_attribute("width") && !root.has_attribute("height") {
            self.found.notes.push(
                "the drawing states no width or height: its units are read as pixels, 96 to the inch"
                    .to_owned(),
            );
        }
    }

    fn element(&mut self, node: Node<'a, 'a>, context: &Context<'a>) -> Result<(), ExemplarFault> {
        let Some(tag) = svg_tag(node) else { return Ok(()) };
        self.elements += 1;
        if self.elements > self.limits.elements {
            return Err(ExemplarFault::TooManyElements { limit: self.limits.elements });
        }
        if context.depth > self.limits.nesting {
            return Err(ExemplarFault::TooDeep {
                place: self.source.place(node),
                limit: self.limits.nesting,
            });
        }
        let strict = self.strictness == Strictness::Ink;
        let declared = if strict { self.cascade.declared(self.source, node)? } else { Vec::new() };
        let value = |name: &str| declared.iter().find(|d| d.name == name).map(|d| d.value);
        if value("display") == Some("none") {
            return Ok(());
        }
        let visible = match value("visibility") {
            None | Some("inherit") => context.visible,
            Some(visibility) => visibility == "visible",
        };
        let dashed = match value("stroke-dasharray") {
            None | Some("inherit") => context.dashed,
            Some(dashes) => dashes != "none",
        };
        let inner = Context { depth: context.depth + 1, visible, dashed, used: false, ..context.clone() };
        match tag {
            "symbol" if !context.used => Ok(()),
            "svg" | "g" | "a" | "symbol" | "switch" | "use" => {
                if strict {
                    self.conditions(node, &declared)?;
                    self.properties(node, &declared, &inner)?;
                }
                match tag {
                    "use" => self.follow(node, &inner),
                    "switch" => self.switch(node, &inner),
                    _ => {
                        if strict && tag != "g" && tag != "a" {
                            self.checker.viewport(node)?;
                        }
                        self.children(node, &inner)
                    }
                }
            }
            _ if SHAPES.contains(&tag) => {
                if !strict {
                    return Ok(());
                }
                self.conditions(node, &declared)?;
                if visible { self.shape(node, tag, &declared, &inner) } else { Ok(()) }
            }
            _ if strict && visible => self.other(node, tag),
            _ => Ok(()),
        }
    }

    fn children(&mut self, node: Node<'a, 'a>, context: &Context<'a>) -> Result<(), ExemplarFault> {
        node.children().try_for_each(|child| self.element(child, context))
    }

    fn shape(
        &mut self,
        node: Node<'a, 'a>,
        tag: &str,
        declared: &[Declared<'a>],
        context: &Context<'a>,
    ) -> Result<(), ExemplarFault> {
        let count = self.checker.shape(node, tag)?;
        self.segments += count;
        if self.segments > self.limits.segments {
            let place = self.source.place(node);
            return Err(ExemplarFault::TooManySegments { place, limit: self.limits.segments });
        }
        self.properties(node, declared, context)?;
        if context.dashed && node.has_attribute("pathLength") {
            let what = "has dashes measured by pathLength, which is not read here";
            return Err(self.unsupported(node, what, "remove pathLength and scale the dashes"));
        }
        // A path without data, or with a lone "move to", draws nothing by the rules of SVG.
        if tag == "path" && count <= 1 {
            let note = format!("{} has no segments and draws nothing", self.source.place(node));
            self.found.notes.push(note);
            return Ok(());
        }
        let anchor = context.anchor.unwrap_or(node);
        let label = label(anchor);
        if context.counted && !label.is_empty() {
            let place = self.source.place(anchor);
            self.found.expected.entry(label).or_insert((0, place)).0 += 1;
        }
        Ok(())
    }

    /// Elements that neither group nor draw shapes.
    fn other(&mut self, node: Node<'a, 'a>, tag: &str) -> Result<(), ExemplarFault> {
        match tag {
            // Definitions, descriptions and style.
            "defs" | "clipPath" | "mask" | "marker" | "pattern" | "linearGradient" | "radialGradient"
            | "filter" | "style" | "title" | "desc" | "metadata" | "view" | "cursor" | "font"
            | "font-face" | "color-profile" | "solidcolor" | "solidColor" | "hatch" | "meshgradient"
            | "mesh" => Ok(()),
            "script" | "animate" | "animateMotion" | "animateTransform" | "animateColor" | "set"
            | "discard" => {
                self.found.notes.push(format!(
                    "{} is not run: the drawing is read as it stands",
                    self.source.place(node)
                ));
                Ok(())
            }
            "text" | "tspan" | "textPath" | "tref" | "flowRoot" => {
                let characters = node.descendants().filter_map(|n| n.text()).any(|t| !t.trim().is_empty());
                let linked = node.descendants().any(|n| svg_tag(n) == Some("tref"));
                if characters || linked {
                    return Err(ExemplarFault::Text { place: self.source.place(node) });
                }
                Ok(())
            }
            "image" => Err(self.unsupported(
                node,
                "is a picture made of pixels",
                "trace it to paths (in Inkscape: Path, Trace Bitmap) or delete it",
            )),
            "foreignObject" | "video" | "audio" | "iframe" | "canvas" | "object" | "embed" => Err(self
                .unsupported(
                    node,
                    "holds something other than SVG shapes",
                    "delete it or redraw it as paths",
                )),
            _ => Err(self.unsupported(
                node,
                "is not an element of SVG that is known here",
                "delete it or redraw it as paths",
            )),
        }
    }

    fn conditions(&self, node: Node, declared: &[Declared]) -> Result<(), ExemplarFault> {
        for name in ["requiredFeatures", "systemLanguage", "requiredExtensions"] {
            if declared.iter().any(|d| d.name == name)
                && node.parent_element().is_none_or(|p| svg_tag(p) != Some("switch"))
            {
                let what = format!("is shown only under a condition ({name})");
                return Err(self.unsupported(node, what, "remove the condition, or delete the element"));
            }
        }
        Ok(())
    }

    /// The first child without a condition; children that need extensions are passed over, as in any viewer.
    fn switch(&mut self, node: Node<'a, 'a>, context: &Context<'a>) -> Result<(), ExemplarFault> {
        for child in node.children().filter(|&c| svg_tag(c).is_some()) {
            if child.has_attribute("requiredExtensions") {
                self.found
                    .notes
                    .push(format!("{} needs an extension and is passed over", self.source.place(child)));
                continue;
            }
            if let Some(name) =
                ["requiredFeatures", "systemLanguage"].into_iter().find(|n| child.has_attribute(*n))
            {
                let what = format!("is shown only under a condition ({name})");
                return Err(self.unsupported(child, what, "remove the condition, or delete the element"));
            }
            return self.element(child, context);
        }
        Ok(())
    }

    fn follow(&mut self, node: Node<'a, 'a>, context: &Context<'a>) -> Result<(), ExemplarFault> {
        let strict = self.strictness == Strictness::Ink;
        let link = href(node).unwrap_or_default();
        let broken = |problem| {
            if !strict {
                return Ok(());
            }
            let (place, target) = (self.source.place(node), shortened(link));
            Err(ExemplarFault::Reference { place, property: "href".into(), target, problem })
        };
        let Some(id) = link.trim().strip_prefix('#') else {
            return broken("which is not in this file");
        };
        let Some(&target) = self.ids.get(id) else {
            return broken("which does not exist");
        };
        let drawable = |tag: &str| {
            SHAPES.contains(&tag)
                || ["g", "a", "svg", "symbol", "use", "switch", "text", "image"].contains(&tag)
        };
        if !svg_tag(target).is_some_and(drawable) {
            return broken("which is nothing that can be drawn");
        }
        if self.open_uses.contains(&node.id()) || node.ancestors().any(|a| a == target) {
            return Err(ExemplarFault::RecursiveUse { place: self.source.place(node) });
        }
        if strict {
            self.checker.lengths(node, "use")?;
        }
        self.open_uses.push(node.id());
        let anchor = context.anchor.or(Some(node));
        let result = self.element(target, &Context { anchor, used: true, ..context.clone() });
        self.open_uses.pop();
        result
    }

    fn properties(
        &mut self,
        node: Node<'a, 'a>,
        declared: &[Declared<'a>],
        context: &Context<'a>,
    ) -> Result<(), ExemplarFault> {
        for d in declared {
            self.checker.property(node, d)?;
            match d.name {
                "fill" | "stroke" => self.paint_link(node, d)?,
                "clip-path" => self.refer(node, d, "clipPath", context)?,
                "marker-start" | "marker-mid" | "marker-end" => self.refer(node, d, "marker", context)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// A link to a paint; with a fallback, SVG itself says what to do when it is broken.
    fn paint_link(&self, node: Node, d: &Declared) -> Result<(), ExemplarFault> {
        let Ok(Paint::FuncIRI(id, None)) = Paint::from_str(d.value) else { return Ok(()) };
        let problem = match self.ids.get(id).and_then(|&n| svg_tag(n)) {
            Some("linearGradient" | "radialGradient" | "pattern") => return Ok(()),
            Some(_) => "which is not a gradient",
            None => "which does not exist",
        };
        let (place, target) = (self.source.place(node), shortened(id));
        Err(ExemplarFault::Reference { place, property: d.name.to_owned(), target, problem })
    }

    /// Looks once into the clip path or marker that a property names.
    fn refer(
        &mut self,
        node: Node,
        d: &Declared,
        wanted: &str,
        context: &Context<'a>,
    ) -> Result<(), ExemplarFault> {
        if matches!(d.value, "none" | "inherit") {
            return Ok(());
        }
        if wanted == "marker" && !context.counted {
            let what = "has markers inside of a marker or clip path";
            return Err(self.unsupported(node, what, "remove the inner markers"));
        }
        let fault = |problem| {
            let (place, target) = (self.source.place(node), shortened(d.value));
            Err(ExemplarFault::Reference { place, property: d.name.to_owned(), target, problem })
        };
        let Ok(iri) = FuncIRI::from_str(d.value) else {
            return fault("which is not a link of the form url(#id)");
        };
        let Some(&target) = self.ids.get(iri.0) else {
            return fault("which does not exist");
        };
        if svg_tag(target) != Some(wanted) {
            return fault("which is an element of another kind");
        }
        if self.referenced.insert(target.id()) {
            let declared = self.cascade.declared(self.source, target)?;
            let inner = Context {
                depth: context.depth + 1,
                anchor: None,
                counted: false,
                visible: true,
                dashed: false,
                used: false,
            };
            if wanted == "clipPath" {
                self.properties(target, &declared, &inner)?;
            } else {
                self.checker.view_box(target)?;
            }
            let before = self.elements;
            self.children(target, &inner)?;
            if wanted == "marker" {
                let place = self.source.place(target);
                self.marker.get_or_insert((place, 0)).1 += self.elements - before;
            }
        }
        Ok(())
    }
}
