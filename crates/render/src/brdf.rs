use glam::{Vec2, Vec3};
use lie_scene::{Scene, Surface};

use std::f32::consts::{FRAC_1_PI, PI};

/// A surface's reflection at one point for one direction to the eye: Lambert plus GGX, as
/// glTF 2.0 describes it (appendix B), with Smith's height-correlated masking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brdf {
    pub(crate) normal: Vec3,
    pub(crate) geometric_normal: Vec3,
    pub(crate) wo: Vec3,
    /// Albedo over π.
    pub(crate) diffuse: Vec3,
    /// Reflectance at normal and at grazing incidence; none of both is pure Lambert.
    pub(crate) f0: Vec3,
    pub(crate) f90: f32,
    pub(crate) alpha: f32,
    pub(crate) cos_o: f32,
}

/// What a surface reflects from one direction, lobe by lobe, in sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BrdfParts {
    /// Albedo over π, without what the specular lobe reflects.
    pub(crate) diffuse: Vec3,
    pub(crate) specular: Vec3,
}

impl Brdf {
    /// Smallest GGX α: perceptual roughness 0.03. A perfect mirror shows no point light.
    pub(crate) const MIN_ALPHA: f32 = 1.0e-3;

    /// Smallest cosine to the eye.
    pub(crate) const MIN_COSINE: f32 = 1.0e-4;

    /// GGX α below which a surface is smooth: perceptual roughness 0.5.
    pub(crate) const SMOOTH_ALPHA: f32 = 0.25;

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
            cos_o: surface.shading_normal.dot(surface.wo).max(Self::MIN_COSINE),
        }
    }

    /// Reflected radiance per irradiance on a surface facing the light: the BRDF times the
    /// cosine, in sr⁻¹. Zero where `wi` (unit length, towards the light) is behind the
    /// surface or behind its shading normal.
    #[must_use]
    #[inline]
    pub fn times_cosine(&self, wi: Vec3) -> Vec3 {
        let Some(cos_i) = self.cosine(wi) else {
            return Vec3::ZERO;
        };
        let parts = self.parts(wi, cos_i);
        (parts.diffuse + parts.specular) * cos_i
    }

    /// The cosine to a direction of unit length; `None` behind the surface or its shading
    /// normal.
    #[inline]
    pub(crate) fn cosine(&self, wi: Vec3) -> Option<f32> {
        let cos_i = self.normal.dot(wi);
        (cos_i > 0.0 && self.geometric_normal.dot(wi) > 0.0).then_some(cos_i)
    }

    /// The two lobes for a direction above the surface, and its cosine.
    #[inline]
    pub(crate) fn parts(&self, wi: Vec3, cos_i: f32) -> BrdfParts {
        if self.is_matt() {
            return BrdfParts {
                diffuse: self.diffuse,
                specular: Vec3::ZERO,
            };
        }
        let half = (wi + self.wo).normalize_or(self.normal);
        let grazing = 1.0 - self.wo.dot(half).clamp(0.0, 1.0);
        let grazing2 = grazing * grazing;
        let fresnel = self.f0 + (Vec3::splat(self.f90) - self.f0) * (grazing2 * grazing2 * grazing);
        let a2 = self.alpha * self.alpha;
        let masking_i = self.cos_o * (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
        let masking_o = cos_i * (self.cos_o * self.cos_o * (1.0 - a2) + a2).sqrt();
        let spread = self.spread(half);
        let lobe = 0.5 * a2 / (PI * spread * spread * (masking_i + masking_o));
        BrdfParts {
            diffuse: self.diffuse * (Vec3::ONE - fresnel),
            specular: fresnel * lobe,
        }
    }

    /// Whether the surface is so smooth that a light is better found by where the surface
    /// reflects to than by where the light is: perceptual roughness below 0.5.
    #[must_use]
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.alpha < Self::SMOOTH_ALPHA && !self.is_matt()
    }

    /// Whether it is pure Lambert.
    #[must_use]
    #[inline]
    pub fn is_matt(&self) -> bool {
        self.f90 == 0.0 && self.f0 == Vec3::ZERO
    }

    /// A direction of the specular lobe, by the distribution of visible normals (Heitz
    /// 2018, *Sampling the GGX Distribution of Visible Normals*). It may point below the
    /// surface; [`Self::times_cosine`] is zero there.
    #[must_use]
    pub fn sample_specular(&self, square: Vec2) -> Vec3 {
        let (tangent, bitangent) = self.normal.any_orthonormal_pair();
        let wo = Vec3::new(tangent.dot(self.wo), bitangent.dot(self.wo), self.cos_o);
        // The view on a hemisphere of unit roughness.
        let stretched = Vec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalize_or(Vec3::Z);
        let (across, along) = stretched.any_orthonormal_pair();
        let radius = square.x.sqrt();
        let disk = radius * Vec2::from_angle(2.0 * PI * square.y);
        let lean = 0.5 * (1.0 + stretched.z);
        // The half of the disk that the view does not see is squeezed into the other.
        let facing = Vec3::Z - stretched * stretched.z;
        let up = facing.try_normalize().unwrap_or(across);
        let side = stretched.cross(up).normalize_or(along);
        let y = (1.0 - lean) * (1.0 - disk.x * disk.x).max(0.0).sqrt() + lean * disk.y;
        let z = (1.0 - disk.x * disk.x - y * y).max(0.0).sqrt();
        let visible = disk.x * side + y * up + z * stretched;
        let half = Vec3::new(
            self.alpha * visible.x,
            self.alpha * visible.y,
            visible.z.max(0.0),
        );
        let half = half.normalize_or(Vec3::Z);
        let half = half.x * tangent + half.y * bitangent + half.z * self.normal;
        (2.0 * self.wo.dot(half) * half - self.wo).normalize_or(self.normal)
    }

    /// Density of [`Self::sample_specular`] at a direction, in sr⁻¹.
    #[must_use]
    #[inline]
    pub fn specular_density(&self, wi: Vec3) -> f32 {
        let half = (wi + self.wo).normalize_or(self.normal);
        if self.normal.dot(half) <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        // G₁(wo) · D / (4 cos θₒ), with the cosine cancelled.
        let root = (self.cos_o * self.cos_o * (1.0 - a2) + a2).sqrt();
        self.distribution(half) * 0.5 / (self.cos_o + root)
    }

    /// The GGX distribution of microfacet normals, in sr⁻¹.
    #[inline]
    fn distribution(&self, half: Vec3) -> f32 {
        let a2 = self.alpha * self.alpha;
        let spread = self.spread(half);
        a2 / (PI * spread * spread)
    }

    /// How far a microfacet normal is from the surface's, squared, in terms of the roughness.
    #[inline]
    fn spread(&self, half: Vec3) -> f32 {
        let cos = self.normal.dot(half).max(0.0);
        // Not 1 − cos²: on smooth surfaces the lobe is so narrow that all digits would cancel.
        let sin2 = self.normal.cross(half).length_squared();
        cos * cos * (self.alpha * self.alpha) + sin2
    }
}
