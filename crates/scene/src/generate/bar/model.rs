use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use crate::generate::mesh::Mesh;

/// A thing of several materials, about an origin of its own.
#[derive(Clone, Default)]
pub(super) struct Model {
    /// By material, in order, so that a scene is the same every time.
    meshes: BTreeMap<u32, Mesh>,
}

impl Model {
    /// What there is of one material, to add to.
    pub(super) fn of(&mut self, material: u32) -> &mut Mesh {
        self.meshes.entry(material).or_default()
    }

    /// Adds a mesh, moved.
    pub(super) fn add(&mut self, material: u32, mesh: &Mesh, at: Vec3) {
        self.of(material).add(mesh, Quat::IDENTITY, at);
    }

    /// Adds a copy of another model, turned and moved.
    pub(super) fn place(&mut self, other: &Self, turn: Quat, at: Vec3) {
        for (material, mesh) in &other.meshes {
            self.of(*material).add(mesh, turn, at);
        }
    }

    pub(super) fn into_meshes(self) -> impl Iterator<Item = (u32, Mesh)> {
        self.meshes.into_iter()
    }
}
