//! Trees in tubs, cut to balls.

use glam::{Quat, Vec2, Vec3};

use super::{BALCONY, Site};
use crate::generate::{
    mesh::Mesh,
    shapes::{lathe, rod, sphere},
};

impl Site {
    pub(super) fn add_planting(&mut self) {
        for (index, (x, y, z, height)) in [
            (-4.9, 0.0, 11.2, 2.9),
            (5.3, 0.0, 8.4, 3.0),
            (-4.4, 0.0, -8.0, 2.3),
            (-7.1, BALCONY, 6.0, 1.7),
        ]
        .into_iter()
        .enumerate()
        {
            self.add_tree(index, Vec3::new(x, y, z), height);
        }
    }

    fn add_tree(&mut self, index: usize, foot: Vec3, height: f32) {
        let own = self.key.mix(60 + index as u64);
        let size = (height / 2.8).sqrt();
        let at = |radius: f32, y: f32| size * Vec2::new(radius, y);
        let mut tub = Mesh::default();
        let profile = [at(0.36, 0.0), at(0.46, 0.6), at(0.38, 0.54)];
        tub.add(&lathe(&profile, self.fine(8)), Quat::IDENTITY, foot);
        self.part(format!("tub {index}"), self.palette.concrete, tub);
        let mut soil = Mesh::default();
        let profile = [at(0.42, 0.55), at(0.0, 0.56)];
        soil.add(&lathe(&profile, self.fine(8)), Quat::IDENTITY, foot);
        self.part(format!("soil {index}"), self.palette.soil, soil);
        let mut trunk = Mesh::default();
        let crown = foot + Vec3::new(0.1 * (own.uniform(0) - 0.5), 0.62 * height, 0.0);
        let low = foot + 0.5 * size * Vec3::Y;
        trunk.add(
            &rod(low, crown, 0.045 * size, 5),
            Quat::IDENTITY,
            Vec3::ZERO,
        );
        self.part(format!("trunk {index}"), self.palette.bark, trunk);
        let mut leaves = Mesh::default();
        let radius = size * (0.62 + 0.12 * own.uniform(1));
        let lift = 0.6 * radius * Vec3::Y;
        leaves.add(&sphere(radius, self.fine(11)), Quat::IDENTITY, crown + lift);
        self.part(format!("leaves {index}"), self.palette.leaf, leaves);
    }
}
