use glam::{UVec2, Vec3};
use lie_geom::sampling::strata;
use lie_scene::{Camera, Surface};

use crate::{
    Brdf, FrameSettings, LieLookup, LightAnswer, LightPoints, LightRay, World,
    cell_answers::{CellAnswers, RayAnswer},
    expected_error::{AtStake, at_stake},
};

/// The light of one camera ray, light by light: as LIEs have it, and as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelLight {
    /// What is seen.
    pub surface: Surface,
    /// How far it is from the eye, in metres.
    pub distance: f32,
    /// What it emits, in W·sr⁻¹·m⁻².
    pub emitted: Vec3,
    /// Every light of the scene, in order of their number.
    pub lights: Vec<LightShare>,
}

/// What one light gives a surface point. Radiances are reflected towards the eye, in
/// W·sr⁻¹·m⁻².
#[derive(Clone, Debug, PartialEq)]
pub struct LightShare {
    /// Number of the light.
    pub light: u32,
    /// How the LIE finds its light.
    pub answer: LightAnswer,
    /// What it would give if nothing were in the way.
    pub unoccluded: Vec3,
    /// What it gives: every ray traced through the scene, as the standard ray tracer does.
    pub exact: Vec3,
    /// What is shaded with LIEs.
    pub shaded: Vec3,
    /// What depends on the rays that the LIE answers.
    pub at_stake: AtStake,
    /// Shadow rays through the scene that the standard ray tracer casts.
    pub standard_rays: u32,
    /// Those of them that are cast with LIEs.
    pub traced_rays: u32,
    /// Those that are tested against an occluder list instead.
    pub list_rays: u32,
    /// Triangles in the list, for each of these rays.
    pub occluder_tests: u64,
    /// Triangles that block rays which the LIE says reach the light: it is wrong about them.
    pub missed: Vec<u32>,
}

impl PixelLight {
    /// That of a pixel's first camera ray, with the random numbers of a frame: through its
    /// centre if there is one ray to a pixel. `None` where nothing is seen.
    #[must_use]
    pub fn of(
        world: &World,
        lies: &dyn LieLookup,
        camera: &Camera,
        settings: &FrameSettings,
        pixel: UVec2,
    ) -> Option<Self> {
        let (ray, key) = settings.camera_ray(&camera.film(settings.size), pixel, 0);
        let surface = world.first_surface(&ray)?;
        let brdf = Brdf::new(world.scene(), &surface);
        let points = LightPoints {
            surface: &surface,
            brdf: &brdf,
            key,
            strata: strata(settings.light_samples),
        };
        let answers = CellAnswers::new(world, lies.cell(surface.shadow_origin));
        let lights = 0..world.scene().lights.len() as u32;
        let mut lights: Vec<LightShare> = lights
            .map(|light| LightShare::of(world, &answers, &points, light))
            .collect();
        // Rays along a smooth surface's lobe are traced whatever is known.
        let mut directions = vec![];
        points.lobe_directions(&mut directions);
        world.for_each_lobe_ray(&points, &directions, |ray| {
            lights[ray.light as usize].add(world, &ray, RayAnswer::Traced);
        });
        Some(Self {
            distance: surface.position.distance(camera.eye),
            emitted: world.emission(&surface),
            surface,
            lights,
        })
    }
}

impl LightShare {
    fn of(world: &World, answers: &CellAnswers<'_>, points: &LightPoints<'_>, light: u32) -> Self {
        let mut share = Self {
            light,
            answer: answers.of(light),
            unoccluded: Vec3::ZERO,
            exact: Vec3::ZERO,
            shaded: Vec3::ZERO,
            at_stake: at_stake(answers, points, light),
            standard_rays: 0,
            traced_rays: 0,
            list_rays: 0,
            occluder_tests: 0,
            missed: vec![],
        };
        let is_asked = !answers.is_clear(light, points.surface.shadow_origin);
        answers.for_each_ray(light, points, |ray, fate| {
            share.add(world, ray, fate);
            if let (LightAnswer::Listed(occluders), true) =
                (share.answer, is_asked && fate != RayAnswer::Traced)
            {
                share.list_rays += 1;
                share.occluder_tests += occluders;
            }
        });
        share
    }

    fn add(&mut self, world: &World, ray: &LightRay, fate: RayAnswer) {
        let blocker = world.accel().blocker(&ray.ray);
        let exact = match blocker {
            Some(_) => Vec3::ZERO,
            None => ray.radiance,
        };
        self.standard_rays += 1;
        self.unoccluded += ray.radiance;
        self.exact += exact;
        match fate {
            RayAnswer::Shown => {
                self.shaded += ray.radiance;
                self.missed
                    .extend(blocker.filter(|blocker| !self.missed.contains(blocker)));
            }
            RayAnswer::Withheld => {}
            RayAnswer::Traced => {
                self.shaded += exact;
                self.traced_rays += 1;
            }
        }
    }

    /// Shadow rays that LIEs save.
    #[must_use]
    pub fn saved_rays(&self) -> u32 {
        self.standard_rays - self.traced_rays
    }
}

#[cfg(test)]
mod tests;
