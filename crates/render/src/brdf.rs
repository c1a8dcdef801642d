use glam::Vec3;
use lie_scene::{Scene, Surface};

use std::f32::consts::{FRAC_1_PI, PI};

/// A surface's reflection at one point for one direction to the eye: Lambert plus GGX, as
/// glTF 2.0 describes it (appendix B), with Smith's height-correlated masking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brdf {
    normal: Vec3,
    geometric_normal: Vec3,
    wo: Vec3,
    /// Albedo over π.
    diffuse: Vec3,
    /// Reflectance at normal and at grazing incidence; none of both is pure Lambert.
    f0: Vec3,
    f90: f32,
    alpha: f32,
    cos_o: f32,
}

impl Brdf {
    /// Smallest GGX α: perceptual roughness 0.03. A perfect mirror shows no point light.
    const MIN_ALPHA: f32 = 1.0e-3;

    /// The reflection at a surface.
    #[must_use]
    pub fn new(scene: &Scene, surface: &Surface) -> Self {
        let specular = scene.material_at(surface).specular;
        let metallic = surface.metallic;
        Self {
            normal: surface.shading_normal,
            geometric_normal: surface.geometric_normal,
            wo: surface.wo,
            diffuse: surface.base_color * (1.0 - metallic) * FRAC_1_PI,
            f0: Vec3::splat(0.04 * specular).lerp(surface.base_color, metallic),
            f90: specular + (1.0 - specular) * metallic,
            alpha: (surface.roughness * surface.roughness).max(Self::MIN_ALPHA),
            cos_o: surface.shading_normal.dot(surface.wo).max(1.0e-4),
        }
    }

    /// Reflected radiance per irradiance on a surface facing the light: the BRDF times the
    /// cosine, in sr⁻¹. Zero where `wi` (unit length, towards the light) is behind the
    /// surface or behind its shading normal.
    #[must_use]
    #[inline]
    pub fn times_cosine(&self, wi: Vec3) -> Vec3 {
        let cos_i = self.normal.dot(wi);
        if cos_i <= 0.0 || self.geometric_normal.dot(wi) <= 0.0 {
            return Vec3::ZERO;
        }
        if self.f90 == 0.0 && self.f0 == Vec3::ZERO {
            return self.diffuse * cos_i;
        }
        let half = (wi + self.wo).normalize_or(self.normal);
        let cos_h = self.normal.dot(half).max(0.0);
        let grazing = 1.0 - self.wo.dot(half).clamp(0.0, 1.0);
        let grazing2 = grazing * grazing;
        let fresnel = self.f0 + (Vec3::splat(self.f90) - self.f0) * (grazing2 * grazing2 * grazing);
        let a2 = self.alpha * self.alpha;
        let d = cos_h * cos_h * (a2 - 1.0) + 1.0;
        let distribution = a2 / (PI * d * d);
        let masking_i = self.cos_o * (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
        let masking_o = cos_i * (self.cos_o * self.cos_o * (1.0 - a2) + a2).sqrt();
        let specular = fresnel * (distribution * 0.5 / (masking_i + masking_o));
        (self.diffuse * (Vec3::ONE - fresnel) + specular) * cos_i
    }
}
