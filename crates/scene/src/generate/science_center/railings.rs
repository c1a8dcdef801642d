//! Parapets round the upper floors, and railings of flat bars along the stairs.

use glam::Vec3;

use super::{
    BALCONY, BALCONY_EDGE, FRONT, GALLERY, GALLERY_EDGE, SLAB, Site,
    stairs::{GALLERY_WELL, WIDE_HALF, narrow_flight, wide_flights},
};
use crate::generate::mesh::Mesh;

/// Height of the handrail's underside above the floor.
const HEIGHT: f32 = 1.02;
/// Largest way between two posts.
const SPACING: f32 = 1.6;
/// How far a parapet's middle stands back from the floor's edge: less than half its thickness,
/// so that it covers the edge.
const INSET: f32 = 0.02;

impl Site {
    pub(super) fn add_railings(&mut self) {
        let (edge, back) = (BALCONY_EDGE[0] + INSET, BALCONY_EDGE[1] - INSET);
        let front = FRONT - 0.06;
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let gap = WIDE_HALF + 0.06;
        let (mut parapets, mut flights) = (vec![], vec![narrow_flight().railing(1.0).to_vec()]);
        for side in [-1.0, 1.0] {
            parapets.push(vec![
                at(side * edge, BALCONY, front),
                at(side * edge, BALCONY, back),
                at(side * gap, BALCONY, back),
            ]);
            let [lower, upper] = wide_flights().map(|flight| flight.railing(side));
            flights.push(vec![lower[0], lower[1], upper[0], upper[1]]);
        }
        let (edge, back) = (GALLERY_EDGE[0] + INSET, GALLERY_EDGE[1] - INSET);
        parapets.push(vec![
            at(-edge, GALLERY, front),
            at(-edge, GALLERY, back),
            at(edge, GALLERY, back),
            at(edge, GALLERY, front),
        ]);
        let [x, z] = GALLERY_WELL;
        parapets.push(vec![
            at(x[0] - INSET, GALLERY, z[0] + 0.1),
            at(x[0] - INSET, GALLERY, z[1] + INSET),
            at(x[1], GALLERY, z[1] + INSET),
        ]);
        let [mut panels, mut metal, mut timber] = std::array::from_fn(|_| Mesh::default());
        for pair in parapets.iter().flat_map(|run| run.windows(2)) {
            add_parapet(&mut panels, &mut timber, pair[0], pair[1]);
        }
        for pair in flights.iter().flat_map(|run| run.windows(2)) {
            add_railing(&mut metal, &mut timber, pair[0], pair[1]);
        }
        self.part("parapets", self.palette.column, panels);
        self.part("stair railings", self.palette.steel, metal);
        self.part("handrails", self.palette.oak, timber);
    }
}

/// A closed parapet with a handrail on it, from foot to foot along a floor's edge.
fn add_parapet(panels: &mut Mesh, timber: &mut Mesh, from: Vec3, to: Vec3) {
    beam(
        panels,
        [from, to],
        -SLAB - 0.02,
        [0.03, SLAB + HEIGHT + 0.03],
    );
    beam(timber, [from, to], HEIGHT, [0.055, 0.07]);
}

/// An open railing along a flight: flat posts, a bar half way up, and a handrail.
fn add_railing(metal: &mut Mesh, timber: &mut Mesh, from: Vec3, to: Vec3) {
    let way = to - from;
    let side = Vec3::Y.cross(way).normalize_or(Vec3::X);
    let along = side.cross(Vec3::Y);
    let count = (way.length() / SPACING).ceil().max(1.0) as u32;
    for index in 0..=count {
        let foot = from + way * index as f32 / count as f32;
        let corner = foot - 0.03 * along - 0.012 * side;
        let up = (HEIGHT + 0.03) * Vec3::Y;
        metal.block(corner, 0.06 * along, up, 0.024 * side);
    }
    beam(metal, [from, to], 0.45, [0.012, 0.10]);
    beam(timber, [from, to], HEIGHT, [0.045, 0.06]);
}

/// A bar above the way between two feet: lifted so far, of half a width and a height.
fn beam(mesh: &mut Mesh, [from, to]: [Vec3; 2], lift: f32, [half, height]: [f32; 2]) {
    let way = to - from;
    let side = Vec3::Y.cross(way).normalize_or(Vec3::X);
    let corner = from + lift * Vec3::Y - half * side;
    mesh.block(corner, 2.0 * half * side, height * Vec3::Y, way);
}
