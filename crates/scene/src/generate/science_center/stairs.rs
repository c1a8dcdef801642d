//! The wide stairs from the floor to the balcony, and the narrow ones from there to the gallery.

use glam::Vec3;

use super::{BACK, BALCONY, BALCONY_EDGE, GALLERY, Site, cuboid};
use crate::generate::mesh::Mesh;

/// Half the width of the wide stairs.
pub(super) const WIDE_HALF: f32 = 1.8;
/// The hole in the gallery's floor over the narrow stairs.
pub(super) const GALLERY_WELL: [[f32; 2]; 2] = [[-1.8, 4.2], [BACK, -13.3]];
/// From the wall to the far side of the narrow stairs.
const NARROW_Z: [f32; 2] = [BACK + 0.06, -13.44];
/// Width of the cheeks along both sides of a flight.
const CHEEK: f32 = 0.12;

/// A straight flight.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    /// Foot of the first riser, in the middle.
    pub(super) foot: Vec3,
    /// Unit vector along which it climbs.
    pub(super) along: Vec3,
    pub(super) tread: f32,
    pub(super) riser: f32,
    pub(super) risers: u32,
    pub(super) half_width: f32,
}

impl Flight {
    /// How far it reaches: the last riser ends at the floor above, without a tread.
    fn run(&self) -> f32 {
        self.tread * (self.risers - 1) as f32
    }

    pub(super) fn rise(&self) -> f32 {
        self.riser * self.risers as f32
    }

    /// The foot of the railing on one side, at the flight's beginning and its end.
    pub(super) fn railing(&self, side: f32) -> [Vec3; 2] {
        let across = self.along.cross(Vec3::Y) * side * (self.half_width + 0.5 * CHEEK);
        let foot = self.foot + across + 0.2 * Vec3::Y;
        [
            foot,
            foot + self.run() * self.along + (self.rise() - self.riser) * Vec3::Y,
        ]
    }

    fn steps(&self, mesh: &mut Mesh) {
        let across = self.along.cross(Vec3::Y);
        let width = 2.0 * self.half_width + 0.04;
        for step in 0..self.risers - 1 {
            let top = self.riser * (step + 1) as f32;
            let corner = self.foot - 0.5 * width * across
                + self.tread * step as f32 * self.along
                + (top - self.riser - 0.04).max(0.0) * Vec3::Y;
            let height = self.foot.y + top - corner.y;
            let depth = self.tread + 0.03;
            mesh.block(corner, width * across, height * Vec3::Y, depth * self.along);
        }
    }

    /// A slanting board along each side.
    fn cheeks(&self, mesh: &mut Mesh) {
        let across = self.along.cross(Vec3::Y);
        let slope = self.run() * self.along + (self.rise() - self.riser) * Vec3::Y;
        for side in [-1.0, 1.0] {
            let inner = if side < 0.0 {
                -self.half_width - CHEEK
            } else {
                self.half_width
            };
            let corner = self.foot + inner * across - 0.14 * Vec3::Y;
            mesh.block(corner, CHEEK * across, 0.36 * Vec3::Y, slope);
        }
    }
}

/// The wide stairs: two flights towards −z with a landing between.
pub(super) fn wide_flights() -> [Flight; 2] {
    let upper_foot = BALCONY_EDGE[1] + 13.0 * 0.32;
    let flight = |y: f32, z: f32| Flight {
        foot: Vec3::new(0.0, y, z),
        along: Vec3::NEG_Z,
        tread: 0.32,
        riser: 0.15,
        risers: 14,
        half_width: WIDE_HALF,
    };
    [
        flight(0.0, upper_foot + 1.4 + 13.0 * 0.32),
        flight(0.5 * BALCONY, upper_foot),
    ]
}

/// The narrow stairs, towards +x along the back wall.
pub(super) fn narrow_flight() -> Flight {
    Flight {
        foot: Vec3::new(
            GALLERY_WELL[0][1] - 25.0 * 0.31,
            BALCONY,
            0.5 * (NARROW_Z[0] + NARROW_Z[1]),
        ),
        along: Vec3::X,
        tread: 0.31,
        riser: (GALLERY - BALCONY) / 26.0,
        risers: 26,
        half_width: 0.5 * (NARROW_Z[1] - NARROW_Z[0]) - CHEEK,
    }
}

impl Site {
    pub(super) fn add_stairs(&mut self) {
        let (mut steps, mut cheeks) = (Mesh::default(), Mesh::default());
        let wide = wide_flights();
        for flight in wide.iter().chain([&narrow_flight()]) {
            flight.steps(&mut steps);
            flight.cheeks(&mut cheeks);
        }
        // A little wider than the cheeks: two faces in one plane would fight.
        let reach = WIDE_HALF + CHEEK + 0.015;
        let (front, back) = (wide[1].foot.z + 1.4, wide[1].foot.z);
        let level = wide[1].foot.y;
        cuboid(
            &mut steps,
            [-reach, level - 0.3, back - 0.03],
            [reach, level, front + 0.03],
        );
        // A wall below the landing, and the space under the upper flight closed by another.
        cuboid(
            &mut cheeks,
            [-WIDE_HALF, 0.0, back + 0.2],
            [WIDE_HALF, level - 0.28, front - 0.2],
        );
        self.part("steps", self.palette.oak, steps);
        self.part("stair cheeks", self.palette.plaster[0], cheeks);
    }
}
