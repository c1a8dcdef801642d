use std::sync::Arc;

use glam::Vec3;
use lie_accel::{Accel, AccelKind, Cutout, PACKET, RayPacket};
use lie_geom::{Ray, Triangle};
use lie_scene::{LightKind, Material, Scene, Surface};

use crate::{
    closed_form::Outlines,
    delta_lanes::DeltaLight,
    light_form::{AreaForm, LightForm},
    light_rays::follows_lobe,
};

/// A scene that rays can be shot into.
pub struct World {
    scene: Arc<Scene>,
    accel: Box<dyn Accel>,
    /// For each light, its form for lanes, if it has one.
    delta_lights: Vec<Option<DeltaLight>>,
    /// For each light, its outlines, if it is integrated in closed form.
    outlines: Vec<Option<Outlines>>,
    /// Numbers of the lights that have none and no area either.
    other_lights: Vec<u32>,
    has_lobe_lights: bool,
    has_holes: bool,
    reach: f32,
}

impl World {
    /// Builds the usual acceleration structure, in parallel.
    #[must_use]
    pub fn new(scene: Arc<Scene>) -> Self {
        Self::with_accel(scene, AccelKind::default())
    }

    /// Builds an acceleration structure of some kind, in parallel.
    #[must_use]
    pub fn with_accel(scene: Arc<Scene>, kind: AccelKind) -> Self {
        let has_holes = scene.materials.iter().any(Material::is_masked);
        let cutout: Option<Arc<dyn Cutout>> = if has_holes { Some(scene.clone()) } else { None };
        let accel = kind.build(&scene.geometry, cutout);
        let lights = &scene.lights;
        let delta_lights: Vec<_> = lights.iter().map(DeltaLight::new).collect();
        let is_other =
            |light: &u32| matches!(lights[*light as usize].kind, LightKind::Directional { .. });
        let outlines = lights.iter().map(|light| match &light.kind {
            LightKind::Area(area) => Outlines::new(area),
            _ => None,
        });
        Self {
            outlines: outlines.collect(),
            other_lights: (0..lights.len() as u32).filter(is_other).collect(),
            delta_lights,
            has_holes,
            has_lobe_lights: lights.iter().any(follows_lobe),
            reach: scene.reach(),
            scene,
            accel,
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The structure that serves every ray.
    #[must_use]
    pub fn accel(&self) -> &dyn Accel {
        &*self.accel
    }

    /// A triangle of the scene.
    #[must_use]
    pub fn triangle(&self, index: u32) -> Option<&Triangle> {
        self.scene.geometry.shapes().get(index as usize)
    }

    /// A light in the form that shading wants.
    #[inline]
    pub(crate) fn light_form(&self, light: u32) -> LightForm<'_> {
        match self.delta_lights.get(light as usize) {
            Some(Some(delta)) => LightForm::Delta(delta),
            Some(None) => match &self.scene.lights[light as usize].kind {
                LightKind::Area(area) => LightForm::Area(AreaForm {
                    light: area,
                    outlines: self.outlines[light as usize].as_ref(),
                    ends: area.ends(),
                }),
                _ => LightForm::Other,
            },
            None => LightForm::Other,
        }
    }

    /// The lights that are neither points, spots nor area lights, by number.
    pub(crate) fn other_lights(&self) -> &[u32] {
        &self.other_lights
    }

    /// Whether any light is sampled by where smooth surfaces reflect to.
    pub(crate) fn has_lobe_lights(&self) -> bool {
        self.has_lobe_lights
    }

    /// A distance in metres that leaves the scene from anywhere in it.
    #[must_use]
    pub fn reach(&self) -> f32 {
        self.reach
    }

    /// The closest surface along a ray.
    #[must_use]
    pub fn first_surface(&self, ray: &Ray) -> Option<Surface> {
        self.accel
            .closest(ray)
            .map(|hit| self.scene.surface(ray, &hit))
    }

    /// What a surface emits towards the eye, in W·sr⁻¹·m⁻².
    pub(crate) fn emission(&self, surface: &Surface) -> Vec3 {
        self.emission_of(surface.material, surface.front)
    }

    /// The same of a material, seen from the front or not.
    #[inline]
    pub(crate) fn emission_of(&self, material: u32, front: bool) -> Vec3 {
        let material = &self.scene.materials[material as usize];
        if front || material.double_sided {
            material.emission
        } else {
            Vec3::ZERO
        }
    }

    /// Where triangles have holes, if any has.
    pub(crate) fn cutout(&self) -> Option<&dyn Cutout> {
        self.has_holes.then_some(&*self.scene as &dyn Cutout)
    }

    /// Whether a triangle may have holes.
    #[must_use]
    pub fn has_holes(&self, triangle: u32) -> bool {
        self.has_holes && Cutout::has_holes(&*self.scene, triangle)
    }

    /// Which of some rays (at most sixteen), given as a packet and one by one, a triangle
    /// blocks, holes considered: bit `i` for ray `i`.
    #[must_use]
    pub fn blocked_by(&self, triangle: u32, packet: &RayPacket, rays: &[Ray]) -> u32 {
        let Some(shape) = self.triangle(triangle) else {
            return 0;
        };
        let blocked = packet.blocked_by(shape);
        if blocked == 0 || !Cutout::has_holes(&*self.scene, triangle) {
            return blocked;
        }
        let is_solid = |ray: &Ray| {
            let hit = shape.intersect(ray);
            hit.is_some_and(|hit| self.scene.is_solid(triangle, hit.u, hit.v))
        };
        (0..rays.len().min(PACKET))
            .filter(|&lane| is_solid(&rays[lane]))
            .fold(0, |mask, lane| mask | 1 << lane)
    }
}
