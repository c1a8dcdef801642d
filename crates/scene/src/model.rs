use glam::{UVec2, Vec3};

use crate::{Camera, Geometry, GeometryError, Light, LightKind, Material, Texture, Walkthrough};

/// Everything there is to render, in world space.
///
/// Invariants, checked by [`Self::validate`]: indices of materials and textures are in
/// range, every number is finite, and there is at least one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name to call it by.
    pub name: String,
    /// The triangles.
    pub geometry: Geometry,
    /// The materials that geometry refers to.
    pub materials: Vec<Material>,
    /// The images that materials refer to.
    pub textures: Vec<Texture>,
    /// The lights; their order is their number.
    pub lights: Vec<Light>,
    /// At least one; the first is the default.
    pub cameras: Vec<Camera>,
    /// Paths through the scene; the first is the default. May be none.
    pub walkthroughs: Vec<Walkthrough>,
    /// What is seen where no surface is.
    pub background: Background,
    /// How the scene wants to be rendered.
    pub settings: RenderSettings,
}

/// What is seen where a ray leaves the scene. It gives no light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Background {
    /// Radiance in W·sr⁻¹·m⁻².
    pub radiance: Vec3,
}

/// A scene's own defaults; the command line overrides each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Pixels per row, and rows.
    pub size: UVec2,
    /// Camera rays per pixel.
    pub samples_per_pixel: u32,
    /// Sample points on each area light, for each camera ray.
    pub light_samples: u32,
    /// Exposure in stops: a radiance of 2^−exposure is shown as white by a linear display.
    pub exposure_stops: f32,
    /// Levels below the root that the octree may reach.
    pub max_depth: u32,
    /// Sum of occluders in a cell above which it splits; `None` leaves it to
    /// [`Scene::split_threshold`].
    pub split_threshold: Option<u32>,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            size: UVec2::new(512, 512),
            samples_per_pixel: 1,
            light_samples: 16,
            exposure_stops: 0.0,
            max_depth: 9,
            split_threshold: None,
        }
    }
}

/// Why a [`Scene`] is not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The triangles are wrong.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Something refers to what is not there.
    #[error("{what} refers to {kind} {index}, but there are {count}")]
    Reference {
        /// What refers.
        what: String,
        /// Kind of thing referred to.
        kind: &'static str,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A number is impossible.
    #[error("{what}: {problem}")]
    Value {
        /// Where.
        what: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// No camera.
    #[error("the scene has no camera")]
    NoCamera,
}

impl Scene {
    /// Rays that a surface point may send past occluders before its cell splits.
    const RAYS_PAST_OCCLUDERS: f32 = 24.0;

    /// The sum of occluders in a cell above which it splits: the scene's own, or as many as
    /// cost the same whatever the lights are. A point sends one ray past the occluders of a
    /// light without extent, and one for each sample point past those of an area light.
    #[must_use]
    pub fn split_threshold(&self) -> u32 {
        let rays = |light: &Light| match light.is_delta() {
            true => 1,
            false => u64::from(self.settings.light_samples),
        };
        let all: u64 = self.lights.iter().map(rays).sum();
        let mean = all as f32 / self.lights.len().max(1) as f32;
        let usual = (Self::RAYS_PAST_OCCLUDERS / mean.max(1.0)).round();
        self.settings
            .split_threshold
            .unwrap_or((usual as u32).max(1))
    }

    /// Checks the invariants that no constructor has checked.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn validate(&self) -> Result<(), SceneError> {
        for part in self.geometry.parts() {
            check_index(
                || format!("mesh '{}'", part.name),
                "material",
                part.material,
                self.materials.len(),
            )?;
        }
        for material in &self.materials {
            self.validate_material(material)?;
        }
        for light in &self.lights {
            validate_light(light)?;
        }
        if self.cameras.is_empty() {
            return Err(SceneError::NoCamera);
        }
        for camera in &self.cameras {
            check(
                camera.is_valid(),
                || format!("camera '{}'", camera.name),
                "is not a possible camera",
            )?;
        }
        for walk in &self.walkthroughs {
            let what = || format!("walkthrough '{}'", walk.name);
            let problem = walk.problem();
            check(problem.is_none(), what, problem.unwrap_or_default())?;
        }
        self.settings.validate()
    }

    fn validate_material(&self, material: &Material) -> Result<(), SceneError> {
        let what = || format!("material '{}'", material.name);
        for reference in [
            material.base_color_texture,
            material.metallic_roughness_texture,
        ]
        .into_iter()
        .flatten()
        {
            check_index(what, "texture", reference.texture, self.textures.len())?;
            check(
                reference.texture_from_uv.is_finite(),
                what,
                "has a texture transform that is not finite",
            )?;
        }
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        check(
            material.base_color.to_array().into_iter().all(unit),
            what,
            "has a base colour outside 0 to 1",
        )?;
        check(
            unit(material.metallic)
                && unit(material.roughness)
                && unit(material.specular)
                && unit(material.alpha),
            what,
            "has a metallic, roughness, specular or alpha outside 0 to 1",
        )?;
        check(
            is_radiometric(material.emission),
            what,
            "has a negative or infinite emission",
        )
    }

    /// A length in metres longer than any two points of the scene or its lights are apart.
    #[must_use]
    pub fn reach(&self) -> f32 {
        2.0 * self.geometry.bounds().size().length() + 1.0
    }
}

impl RenderSettings {
    /// Longest side of a picture in pixels.
    pub const MAX_SIDE: u32 = 16_384;
    /// Most camera rays per pixel.
    pub const MAX_SAMPLES_PER_PIXEL: u32 = 4096;
    /// Most sample points per area light.
    pub const MAX_LIGHT_SAMPLES: u32 = 4096;
    /// Deepest octree; a cell's key still fits 64 bits.
    pub const MAX_DEPTH: u32 = 20;

    /// Checks every limit.
    ///
    /// # Errors
    /// The first value out of its range.
    pub fn validate(&self) -> Result<(), SceneError> {
        let what = || "render settings".to_owned();
        let sides = 1..=Self::MAX_SIDE;
        check(
            sides.contains(&self.size.x) && sides.contains(&self.size.y),
            what,
            "a side of the picture is outside 1 to 16384 pixels",
        )?;
        check(
            (1..=Self::MAX_SAMPLES_PER_PIXEL).contains(&self.samples_per_pixel),
            what,
            "samples per pixel are outside 1 to 4096",
        )?;
        check(
            (1..=Self::MAX_LIGHT_SAMPLES).contains(&self.light_samples),
            what,
            "light samples are outside 1 to 4096",
        )?;
        check(
            (1..=Self::MAX_DEPTH).contains(&self.max_depth),
            what,
            "the octree's maximum depth is outside 1 to 20",
        )?;
        check(
            self.split_threshold != Some(0),
            what,
            "the split threshold is zero",
        )?;
        check(
            self.exposure_stops.is_finite() && self.exposure_stops.abs() <= 64.0,
            what,
            "the exposure is outside -64 to 64 stops",
        )
    }
}

fn validate_light(light: &Light) -> Result<(), SceneError> {
    let what = || format!("light '{}'", light.name);
    let unit = |direction: Vec3| direction.is_normalized();
    let (power, placed) = match &light.kind {
        LightKind::Point {
            position,
            radiant_intensity,
        } => (*radiant_intensity, position.is_finite()),
        LightKind::Spot {
            position,
            direction,
            radiant_intensity,
            cos_inner,
            cos_outer,
        } => {
            let cone = cos_outer <= cos_inner && *cos_outer >= -1.0 && *cos_inner <= 1.0;
            check(
                cone,
                what,
                "has an inner cone that is wider than its outer one",
            )?;
            (*radiant_intensity, position.is_finite() && unit(*direction))
        }
        LightKind::Directional {
            direction,
            irradiance,
        } => (*irradiance, unit(*direction)),
        LightKind::Area(area) => (area.radiance, area.area().is_finite()),
    };
    check(
        is_radiometric(power),
        what,
        "has a negative or infinite power",
    )?;
    check(
        placed,
        what,
        "has an impossible position, direction or area",
    )
}

fn is_radiometric(value: Vec3) -> bool {
    value.is_finite() && value.min_element() >= 0.0
}

fn check(holds: bool, what: impl Fn() -> String, problem: &'static str) -> Result<(), SceneError> {
    if holds {
        Ok(())
    } else {
        Err(SceneError::Value {
            what: what(),
            problem,
        })
    }
}

fn check_index(
    what: impl Fn() -> String,
    kind: &'static str,
    index: u32,
    count: usize,
) -> Result<(), SceneError> {
    if (index as usize) < count {
        Ok(())
    } else {
        Err(SceneError::Reference {
            what: what(),
            kind,
            index,
            count,
        })
    }
}

#[cfg(test)]
mod tests {

    #[test]
    fn cells_of_area_lights_split_sooner_by_default() {
        let mut scene = crate::cornell_box();
        scene.settings.light_samples = 64;
        assert_eq!(scene.split_threshold(), 1);
        scene.settings.light_samples = 6;
        assert_eq!(scene.split_threshold(), 4);
        scene.lights.clear();
        assert_eq!(scene.split_threshold(), 24);
        scene.settings.split_threshold = Some(7);
        assert_eq!(scene.split_threshold(), 7);
    }
}
