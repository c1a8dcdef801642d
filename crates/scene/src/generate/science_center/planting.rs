//! Trees in tubs, cut to cubes.

use glam::{Quat, Vec3};

use super::{BALCONY, Site, cuboid};
use crate::generate::{mesh::Mesh, shapes::rod};

impl Site {
    pub(super) fn add_planting(&mut self) {
        for (index, (x, y, z, height)) in [
            (-4.9, 0.0, 10.4, 2.9),
            (4.6, 0.0, 6.6, 2.6),
            (-4.4, 0.0, -8.0, 2.3),
            (-7.3, BALCONY, 3.4, 1.8),
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
        let mut tub = Mesh::default();
        let half = 0.4 * size;
        let [low, rim] = [foot, foot + 0.6 * size * Vec3::Y];
        cuboid(
            &mut tub,
            [low.x - half, low.y, low.z - half],
            [low.x + half, rim.y, low.z + half],
        );
        self.part(format!("tub {index}"), self.palette.concrete, tub);
        let mut soil = Mesh::default();
        let inner = half - 0.06;
        let corner = rim + Vec3::new(-inner, 0.004, -inner);
        soil.quad(corner, 2.0 * inner * Vec3::Z, 2.0 * inner * Vec3::X);
        self.part(format!("soil {index}"), self.palette.soil, soil);
        let mut trunk = Mesh::default();
        let crown = foot + Vec3::new(0.1 * (own.uniform(0) - 0.5), 0.62 * height, 0.0);
        let low = foot + 0.5 * size * Vec3::Y;
        trunk.add(
            &rod(low, crown, 0.045 * size, 4),
            Quat::IDENTITY,
            Vec3::ZERO,
        );
        self.part(format!("trunk {index}"), self.palette.bark, trunk);
        let mut leaves = Mesh::default();
        let half = size * (0.50 + 0.08 * own.uniform(1));
        let corner = Vec3::new(-half, -0.2 * half, -half);
        let edges = 2.0 * half * glam::Mat3::IDENTITY;
        let mut block = Mesh::default();
        block.block(corner, edges.x_axis, edges.y_axis, edges.z_axis);
        let spin = Quat::from_rotation_y(0.4 * (own.uniform(2) - 0.5));
        leaves.add(&block, spin, crown);
        self.part(format!("leaves {index}"), self.palette.leaf, leaves);
    }
}
