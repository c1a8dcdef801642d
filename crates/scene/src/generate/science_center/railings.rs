//! Railings: slender balusters between a timber handrail and a rail at their feet.

use std::f32::consts::TAU;

use glam::{Quat, Vec3};

use super::{
    BALCONY, BALCONY_EDGE, FRONT, GALLERY, GALLERY_EDGE, Site,
    stairs::{GALLERY_WELL, WIDE_HALF, narrow_flight, wide_flights},
};
use crate::generate::mesh::Mesh;

/// Height of the handrail's underside above the floor.
const HEIGHT: f32 = 1.02;
/// Largest way between two balusters.
const SPACING: f32 = 0.95;
/// How far a railing stands back from the floor's edge.
const INSET: f32 = 0.08;

impl Site {
    pub(super) fn add_railings(&mut self) {
        let (edge, back) = (BALCONY_EDGE[0] + INSET, BALCONY_EDGE[1] - INSET);
        let front = FRONT - 0.06;
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let gap = WIDE_HALF + 0.06;
        let mut runs = vec![];
        for side in [-1.0, 1.0] {
            runs.push(vec![
                at(side * edge, BALCONY, front),
                at(side * edge, BALCONY, back),
                at(side * gap, BALCONY, back),
            ]);
            let [lower, upper] = wide_flights().map(|flight| flight.railing(side));
            runs.push(vec![lower[0], lower[1], upper[0], upper[1]]);
        }
        let (edge, back) = (GALLERY_EDGE[0] + INSET, GALLERY_EDGE[1] - INSET);
        runs.push(vec![
            at(-edge, GALLERY, front),
            at(-edge, GALLERY, back),
            at(edge, GALLERY, back),
            at(edge, GALLERY, front),
        ]);
        let [x, z] = GALLERY_WELL;
        runs.push(vec![
            at(x[0] - INSET, GALLERY, z[0] + 0.1),
            at(x[0] - INSET, GALLERY, z[1] + INSET),
            at(x[1], GALLERY, z[1] + INSET),
        ]);
        runs.push(narrow_flight().railing(1.0).to_vec());
        let (mut metal, mut timber) = (Mesh::default(), Mesh::default());
        for run in &runs {
            for pair in run.windows(2) {
                add_railing(&mut metal, &mut timber, pair[0], pair[1]);
            }
        }
        self.part("balusters", self.palette.steel, metal);
        self.part("handrails", self.palette.oak, timber);
    }
}

/// One straight piece from foot to foot, level or not.
fn add_railing(metal: &mut Mesh, timber: &mut Mesh, from: Vec3, to: Vec3) {
    let way = to - from;
    let side = Vec3::Y.cross(way).normalize_or(Vec3::X);
    let along = side.cross(Vec3::Y);
    let count = (way.length() / SPACING).ceil().max(1.0) as u32;
    for index in 0..=count {
        let foot = from + way * index as f32 / count as f32;
        let is_end = index == 0 || index == count;
        post(metal, foot, if is_end { 0.04 } else { 0.022 }, along);
    }
    let beam = |mesh: &mut Mesh, lift: f32, half: f32, height: f32| {
        let corner = from + lift * Vec3::Y - half * side;
        mesh.block(corner, 2.0 * half * side, height * Vec3::Y, way);
    };
    beam(timber, HEIGHT, 0.045, 0.06);
    beam(metal, 0.09, 0.016, 0.03);
}

/// The three sides of a baluster; its ends are in the floor and in the handrail.
fn post(mesh: &mut Mesh, foot: Vec3, radius: f32, along: Vec3) {
    let up = (HEIGHT + 0.03) * Vec3::Y;
    let corner = |index: u32| {
        let turn = Quat::from_rotation_y(TAU * index as f32 / 3.0);
        foot + turn * (radius * along)
    };
    for index in 0..3 {
        let from = corner(index);
        mesh.quad(from, corner(index + 1) - from, up);
    }
}
