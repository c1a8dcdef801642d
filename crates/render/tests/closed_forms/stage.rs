//! What the tests have in common: scenes by hand, and what is seen of them.

use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use lie_render::{FrameSettings, World, render_frame};
use lie_scene::{
    AreaLight, AreaShape, Background, Camera, Geometry, Light, LightKind, Material, MeshPart,
    RenderSettings, Scene, Texture, Vertex,
};

/// A scene under construction.
#[derive(Default)]
pub(crate) struct Stage {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    parts: Vec<MeshPart>,
    materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) lights: Vec<Light>,
    pub(crate) background: Background,
}

impl Stage {
    /// Adds triangles of one material, shaded flat.
    pub(crate) fn triangles(mut self, material: Material, triangles: &[[Vec3; 3]]) -> Self {
        let start = self.triangles.len() as u32;
        for corners in triangles {
            let first = self.vertices.len() as u32;
            self.triangles.push([first, first + 1, first + 2]);
            self.vertices.extend(corners.map(|position| Vertex {
                position,
                normal: Vec3::ZERO,
                uv: Vec2::ZERO,
            }));
        }
        self.part(start, material)
    }

    /// Adds a parallelogram whose front is along `u × v`; texture coordinates follow the edges.
    pub(crate) fn quad(mut self, material: Material, corner: Vec3, u: Vec3, v: Vec3) -> Self {
        let start = self.triangles.len() as u32;
        let first = self.vertices.len() as u32;
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            self.vertices.push(Vertex {
                position: corner + s * u + t * v,
                normal: Vec3::ZERO,
                uv: Vec2::new(s, t),
            });
        }
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + corner);
        self.triangles.extend([[a, b, c], [a, c, d]]);
        self.part(start, material)
    }

    /// A floor at y = 0 that faces up, 40 m wide.
    pub(crate) fn floor(self, material: Material) -> Self {
        let corner = Vec3::new(-20.0, 0.0, -20.0);
        self.quad(material, corner, 40.0 * Vec3::Z, 40.0 * Vec3::X)
    }

    pub(crate) fn light(mut self, kind: LightKind) -> Self {
        self.lights.push(Light {
            name: String::new(),
            kind,
        });
        self
    }

    pub(crate) fn area_light(self, shape: AreaShape, radiance: Vec3) -> Self {
        self.light(LightKind::Area(AreaLight::new(shape, radiance, false)))
    }

    pub(crate) fn world(self) -> World {
        let scene = Scene {
            name: "stage".into(),
            geometry: Geometry::new(self.vertices, self.triangles, self.parts).unwrap(),
            materials: self.materials,
            textures: self.textures,
            lights: self.lights,
            cameras: vec![Camera::look_at("eye", Vec3::ZERO, Vec3::X, Vec3::Y, 1.0)],
            walkthroughs: vec![],
            background: self.background,
            settings: RenderSettings::default(),
        };
        scene.validate().unwrap();
        World::new(Arc::new(scene))
    }

    fn part(mut self, start: u32, material: Material) -> Self {
        self.parts.push(MeshPart {
            name: material.name.clone(),
            triangles: start..self.triangles.len() as u32,
            material: self.materials.len() as u32,
        });
        self.materials.push(material);
        self
    }
}

/// Radiance towards `eye` along the ray that goes through `target`, with so many samples of
/// each area light.
pub(crate) fn seen(world: &World, eye: Vec3, target: Vec3, light_samples: u32, seed: u64) -> Vec3 {
    let camera = Camera::look_at("eye", eye, target, Vec3::Y, 0.5);
    let settings = FrameSettings {
        size: UVec2::ONE,
        samples_per_pixel: 1,
        light_samples,
        seed,
        ward: None,
    };
    render_frame(world, None, &camera, &settings, &mut |_| {})
        .0
        .radiance()[0]
}

/// [`seen`] where no light has an extent: nothing is random.
pub(crate) fn seen_exactly(world: &World, eye: Vec3, target: Vec3) -> Vec3 {
    seen(world, eye, target, 1, 0)
}

/// Independent estimates of one number: their mean, and the standard error of the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) error: f64,
}

impl Estimate {
    /// From `count` values that are independent of each other.
    pub(crate) fn of(count: u32, value: impl Fn(u64) -> f32) -> Self {
        let values: Vec<f64> = (0..u64::from(count))
            .map(|seed| f64::from(value(seed)))
            .collect();
        let n = f64::from(count);
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Self {
            mean,
            error: (squares / (n * (n - 1.0))).sqrt(),
        }
    }

    /// Holds it against the true value: within 4.5 standard errors (passed by chance once in
    /// 100,000 for normal errors; seeds are fixed, so that a pass stays one) and single
    /// precision's 0.02 %.
    pub(crate) fn check(self, expected: f64, what: &str) {
        let tolerance = 4.5 * self.error + 2.0e-4 * expected.abs();
        assert!(
            (self.mean - expected).abs() <= tolerance,
            "{what}: {self:?}, expected {expected} within {tolerance}"
        );
    }
}

/// Irradiance from a polygon of unit radiance, all of it above the horizon of `normal`
/// (Lambert 1760): half the sum over its edges of the angle that an edge subtends, times
/// the cosine between `normal` and the plane through the edge and the point.
pub(crate) fn polygon_irradiance(point: Vec3, normal: Vec3, corners: &[Vec3]) -> f64 {
    let towards = |corner: &Vec3| (corner.as_dvec3() - point.as_dvec3()).normalize();
    let sum: DVec3 = (0..corners.len())
        .map(|i| {
            let (a, b) = (
                towards(&corners[i]),
                towards(&corners[(i + 1) % corners.len()]),
            );
            a.cross(b).normalize() * a.dot(b).clamp(-1.0, 1.0).acos()
        })
        .sum();
    0.5 * sum.dot(normal.as_dvec3()).abs()
}

#[test]
fn lamberts_formula_gives_what_is_known() {
    // A square facing a parallel patch on its axis at half its side: the view factor from
    // tables is 4/π · (1/√2) · atan(1/√2) for the centre of a square with side = 2 · distance.
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, z)| Vec3::new(x, 1.0, z));
    let factor = polygon_irradiance(Vec3::ZERO, Vec3::Y, &corners) / std::f64::consts::PI;
    let expected = 4.0 / std::f64::consts::PI * 0.5f64.sqrt() * 0.5f64.sqrt().atan();
    assert!((factor - expected).abs() < 1.0e-12, "{factor} {expected}");
}
