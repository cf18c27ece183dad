//! Union, difference and intersection of solids, and solids that are moved.
//!
//! The engine is `manifold-rust`, and this file is the only one that knows it. It works in 64-bit floats and its results are closed by
//! construction, but a file holds 32-bit floats, and rounding to them moves corners by micrometres: facets thinner than that turn
//! over and cross their neighbours. So facets that are thin beside the rounding are taken out ([`Mesh::take_out_slivers`]), the corners
//! are rounded and welded, and the result is looked at again ([`Solid::from_facets`], and a search for facets that cross). Where it is
//! not sound it is done once more with a larger thickness, which is still smaller than any chord error; then it is an error.
//! Nothing that leaves this file has to be moved once more.
//!
//! The engine runs on one thread, so that the same solids give the same bytes. Excluded: solids that cross themselves, and
//! surfaces that are not closed.

use std::cmp::Ordering;

use glam::{DAffine3, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error, MeshGLP, OpType};

use super::FabricateError;
use super::slivers::Mesh;
use super::solid::Solid;

/// Facets thinner than so many times the distance of neighbouring 32-bit floats are taken out before corners are rounded, one
/// after the other until the result is sound. A smaller first one leaves facets that rounding turns over; of an object of a
/// decimetre the last one is 0.002 mm, and a larger one would be seen.
const THIN_STEPS: [f64; 3] = [16.0, 64.0, 256.0];

/// Everything that is in any of `solids`. What only touches is joined where faces lie on each other. Without solids there are
/// no shells.
///
/// # Errors
/// [`FabricateError::Rounding`] where the result is finer than the floats of a mesh file; [`FabricateError::Facets`] where
/// solids touch along an edge or in a corner only; [`FabricateError::Engine`].
pub fn union(solids: &[&Solid]) -> Result<Solid, FabricateError> {
    united(solids.iter().map(|solid| manifold(solid)).collect::<Result<_, _>>()?)
}

fn united(mut parts: Vec<Manifold>) -> Result<Solid, FabricateError> {
    // The two smallest each time, so that no large one is gone through over and over.
    while parts.len() > 1 {
        parts.sort_by_key(|part| std::cmp::Reverse(part.num_tri()));
        let (a, b) = (parts.pop().expect("there are two"), parts.pop().expect("there are two"));
        parts.push(checked(b.boolean_with_engine(&a, OpType::Add, BooleanEngine::Exact))?);
    }
    parts.pop().map_or_else(|| Solid::from_facets([]), |whole| rounded(&whole))
}

/// What is in `solid` and not in `taken`. Nothing is left as no shells.
///
/// # Errors
/// As [`union`].
pub fn difference(solid: &Solid, taken: &Solid) -> Result<Solid, FabricateError> {
    of_two(solid, taken, OpType::Subtract)
}

/// What is in both solids; no shells where they have nothing in common, or only touch.
///
/// # Errors
/// As [`union`].
pub fn intersection(a: &Solid, b: &Solid) -> Result<Solid, FabricateError> {
    of_two(a, b, OpType::Intersect)
}

/// What two solids have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// The volume of all of it, in cubic millimetres.
    pub volume_mm3: f64,
    /// How wide the widest piece of it is: twice its volume over its surface. Of a plate that is its thickness, and of no
    /// convex body more than what a ball in it measures across.
    pub width_mm: f64,
    /// The middle of the box around that piece, in millimetres.
    pub position_mm: DVec3,
}

/// A solid in some place, ready for several operations. Corners are 64-bit floats there, and are rounded only in what comes of
/// it.
#[derive(Clone)]
pub struct Body(Manifold);

impl Body {
    /// `solid` where `motion` brings it; a motion that mirrors turns the facets.
    ///
    /// # Errors
    /// [`FabricateError::Motion`] for one that flattens the solid; [`FabricateError::Engine`].
    pub fn new(solid: &Solid, motion: &DAffine3) -> Result<Self, FabricateError> {
        let volume = motion.matrix3.determinant();
        if !volume.is_normal() || !motion.is_finite() {
            return Err(FabricateError::Motion);
        }
        let place = |p: [f32; 3]| motion.transform_point3(DVec3::from_array(p.map(f64::from)));
        let turn = |[a, b, c]: [u32; 3]| if volume < 0.0 { [a, c, b] } else { [a, b, c] };
        let triangles = solid.triangles().iter().map(|&t| turn(t)).collect();
        imported(solid.vertices().iter().map(|&p| place(p)), triangles).map(Self)
    }

    /// The least and the greatest coordinates in millimetres.
    pub fn bounds_mm(&self) -> [DVec3; 2] {
        let bounds = self.0.bounding_box();
        [bounds.min, bounds.max].map(|p| DVec3::new(p.x, p.y, p.z))
    }

    /// What both have in common, measured; `None` where it has no volume.
    ///
    /// # Errors
    /// [`FabricateError::Engine`].
    pub fn overlap(&self, other: &Self) -> Result<Option<Overlap>, FabricateError> {
        let both = checked(self.0.boolean_with_engine(&other.0, OpType::Intersect, BooleanEngine::Exact))?;
        let pieces = both.decompose();
        let volume_mm3: f64 = pieces.iter().map(Manifold::volume).sum();
        let width = |piece: &Manifold| 2.0 * piece.volume() / piece.surface_area().max(f64::MIN_POSITIVE);
        let widest = pieces.iter().max_by(|p, q| width(p).total_cmp(&width(q)));
        Ok(widest.filter(|piece| piece.volume() > 0.0).map(|piece| {
            let middle = piece.bounding_box().center();
            let position_mm = DVec3::new(middle.x, middle.y, middle.z);
            Overlap { volume_mm3, width_mm: width(piece), position_mm }
        }))
    }

    /// Everything that is in any of `bodies`, as [`union`] has it.
    ///
    /// # Errors
    /// As [`union`].
    pub fn union(bodies: &[Self]) -> Result<Solid, FabricateError> {
        united(bodies.iter().map(|body| body.0.clone()).collect())
    }

    /// It as a solid in 32-bit floats.
    ///
    /// # Errors
    /// As [`union`].
    pub fn solid(&self) -> Result<Solid, FabricateError> {
        rounded(&self.0)
    }
}

impl Solid {
    /// The solid in another place: every point p goes to `motion` (p), rounded to 32-bit floats. A motion that mirrors turns
    /// the facets, so that they face outwards again.
    ///
    /// # Errors
    /// [`FabricateError::Motion`] for one that flattens the solid; else as [`union`].
    pub fn moved(&self, motion: &DAffine3) -> Result<Self, FabricateError> {
        match *motion == DAffine3::IDENTITY {
            true => Ok(self.clone()),
            false => Body::new(self, motion)?.solid(),
        }
    }

    /// The solid with fewer facets: edges go where the surface stays within `tolerance_mm` of where it was. What could not be
    /// rounded afterwards stays as it is.
    ///
    /// # Errors
    /// [`FabricateError::Engine`].
    pub fn with_fewer_facets(&self, tolerance_mm: f64) -> Result<Self, FabricateError> {
        let simpler = manifold(self)?.simplify(tolerance_mm);
        let is_same =
            |solid: &Self| solid.shells().len() == self.shells().len() && solid.genus() == self.genus();
        Ok(rounded(&simpler).ok().filter(is_same).unwrap_or_else(|| self.clone()))
    }

    /// The total genus of all shells: the number of tunnels.
    pub fn genus(&self) -> usize {
        // Every edge has two facets, so that V − E + F is V − F/2, and of each shell 2 − 2g.
        let euler = self.vertices().len() as i64 - self.triangles().len() as i64 / 2;
        usize::try_from(self.shells().len() as i64 - euler / 2).expect("closed shells have no negative genus")
    }
}

fn of_two(a: &Solid, b: &Solid, operation: OpType) -> Result<Solid, FabricateError> {
    rounded(&checked(manifold(a)?.boolean_with_engine(&manifold(b)?, operation, BooleanEngine::Exact))?)
}

/// The solid as the engine has it.
fn manifold(solid: &Solid) -> Result<Manifold, FabricateError> {
    let vertices = solid.vertices().iter().map(|&p| DVec3::from_array(p.map(f64::from)));
    imported(vertices, solid.triangles().to_vec())
}

fn imported(
    vertices: impl Iterator<Item = DVec3>,
    triangles: Vec<[u32; 3]>,
) -> Result<Manifold, FabricateError> {
    checked(Manifold::from_mesh_glp(&MeshGLP::<f64, u32> {
        num_prop: 3,
        vert_properties: vertices.flat_map(|p| p.to_array()).collect(),
        tri_verts: triangles.into_flattened(),
        ..Default::default()
    }))
}

/// `made`, unless it stands for a failure.
fn checked(made: Manifold) -> Result<Manifold, FabricateError> {
    match made.status() {
        Error::NoError => Ok(made),
        found => Err(FabricateError::Engine { found: format!("{found:?}") }),
    }
}

/// What the engine made, sound in 32-bit floats.
fn rounded(made: &Manifold) -> Result<Solid, FabricateError> {
    let (vertices, facets) = exported(made);
    let extent = vertices.iter().fold(0.0, |extent: f64, p| extent.max(p.abs().max_element()));
    let step_mm = extent * f64::from(f32::EPSILON);
    let mut fault = None;
    for thin in THIN_STEPS {
        let mut mesh = Mesh::new(vertices.clone(), &facets);
        mesh.take_out_slivers(thin * step_mm);
        let corner = |v: u32| mesh.vertices[v as usize].as_vec3().to_array();
        match Solid::from_facets(mesh.facets().map(|facet| facet.map(corner))) {
            // The exact predicates see what rounding did.
            Ok(solid) if !manifold(&solid)?.has_self_intersections() => return Ok(solid),
            Ok(_) => fault = None,
            Err(found) => fault = Some(found),
        }
    }
    Err(fault.unwrap_or(FabricateError::Rounding { thin_mm: THIN_STEPS[THIN_STEPS.len() - 1] * step_mm }))
}

/// Vertices and facets of what the engine made, in an order that follows from where they are: the engine's own follows from the order in which it
/// was given solids, by whichever thread.
fn exported(made: &Manifold) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mesh: MeshGLP<f64, u32> = made.get_mesh_glp(-1);
    let stride = mesh.num_prop as usize;
    let own: Vec<DVec3> = mesh.vert_properties.chunks_exact(stride.max(3)).map(DVec3::from_slice).collect();
    let place = |v: u32| own[v as usize].to_array();
    let before = |p: &[f64; 3], q: &[f64; 3]| {
        (0..3).map(|i| p[i].total_cmp(&q[i])).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    let mut facets: Vec<[u32; 3]> = mesh.tri_verts.as_chunks::<3>().0.to_vec();
    for facet in &mut facets {
        let first =
            (0..3).min_by(|&i, &j| before(&place(facet[i]), &place(facet[j]))).expect("there are three");
        facet.rotate_left(first);
    }
    facets.sort_by(|f, g| {
        let corners = (0..3).map(|i| before(&place(f[i]), &place(g[i])));
        corners.into_iter().find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    let mut numbers = vec![u32::MAX; own.len()];
    let mut vertices = Vec::with_capacity(own.len());
    for v in facets.iter_mut().flatten() {
        let number = &mut numbers[*v as usize];
        if *number == u32::MAX {
            *number = vertices.len() as u32;
            vertices.push(own[*v as usize]);
        }
        *v = *number;
    }
    (vertices, facets)
}
