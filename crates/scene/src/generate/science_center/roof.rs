//! Ceiling, and the one light: a flat skylight that leans over the front of the atrium.

use glam::Vec3;

use super::{BACK, CEILING, FRONT, SIDE, Site, WALL, cuboid, tiling::Field};
use crate::{Material, generate::mesh::Mesh};

/// Half the width of the sloping part of the roof.
const SLOPE_HALF: f32 = 6.6;
/// Where it meets the ceiling, along z, and how high it is where it meets the front.
const SLOPE_TOP_Z: f32 = 4.6;
const SLOPE_LOW_Y: f32 = 6.8;
/// Width of the frame about the glass.
const FRAME: f32 = 1.5;
/// How far the glass stands before its frame.
const PROUD: f32 = 0.012;
/// What the sky gives, in W·sr⁻¹·m⁻².
const DAYLIGHT: Vec3 = Vec3::new(12.6, 12.4, 12.1);

impl Site {
    /// A level ceiling, and before it the slope over the atrium's front.
    pub(super) fn add_roof(&mut self) {
        let along = |x: f32, z: f32, width: f32, depth: f32| Field {
            corner: Vec3::new(x, CEILING, z),
            u: width * Vec3::X,
            v: depth * Vec3::Z,
        };
        let wing = SIDE - SLOPE_HALF;
        let fields = [
            along(-SIDE, BACK, wing, FRONT - BACK),
            along(SLOPE_HALF, BACK, wing, FRONT - BACK),
            along(-SLOPE_HALF, BACK, 2.0 * SLOPE_HALF, SLOPE_TOP_Z - BACK),
        ];
        self.add_tiles("ceiling", [self.palette.ceiling], &fields, |_, _| 0);
        let mut lid = Mesh::default();
        cuboid(
            &mut lid,
            [-SIDE - WALL, CEILING + 0.05, BACK - WALL],
            [SIDE + WALL, CEILING + 0.3, FRONT + WALL],
        );
        self.part("roof", self.palette.ceiling, lid);
        self.add_slope();
    }

    /// A wedge whose slanting side carries the glass.
    fn add_slope(&mut self) {
        let [low, high] = slope();
        let across = 2.0 * SLOPE_HALF * Vec3::X;
        let mut wedge = Mesh::default();
        wedge.quad(low, high - low, across);
        let top = Vec3::new(low.x, CEILING, low.z);
        wedge.triangle([low, top, high]);
        wedge.triangle([low + across, high + across, top + across]);
        self.part("slope", self.palette.plaster[0], wedge);
    }

    /// The glass: one parallelogram, hence one rectangle that shines into the atrium.
    pub(super) fn add_daylight(&mut self) {
        let material = self.draft.add_material(Material {
            emission: DAYLIGHT,
            ..Material::diffuse("daylight", Vec3::splat(0.8))
        });
        let [low, high] = slope();
        let (across, up) = (Vec3::X, (high - low).normalize_or(Vec3::Y));
        let inward = up.cross(across);
        let corner = low + FRAME * (across + up) + PROUD * inward;
        let (width, length) = (
            2.0 * (SLOPE_HALF - FRAME),
            (high - low).length() - 2.0 * FRAME,
        );
        let mut glass = Mesh::default();
        glass.quad(corner, length * up, width * across);
        self.part("daylight", material, glass);
    }
}

/// The slope's lower and upper edge, at its end towards −x.
fn slope() -> [Vec3; 2] {
    [
        Vec3::new(-SLOPE_HALF, SLOPE_LOW_Y, FRONT),
        Vec3::new(-SLOPE_HALF, CEILING, SLOPE_TOP_Z),
    ]
}
