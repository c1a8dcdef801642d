use glam::{Vec2, Vec3};
use lie_geom::{Hit, Ray, offset_origin};
use multiversion::multiversion;

use crate::{AlphaMode, Material, Scene};

/// The point where a ray met the scene, with all that shading needs to know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point on the triangle.
    pub position: Vec3,
    /// Where shadow rays start: the point moved off the triangle, and back along the ray.
    /// The latter keeps a point in the seam of two walls on the side that was seen.
    pub shadow_origin: Vec3,
    /// Direction back along the ray, unit length.
    pub wo: Vec3,
    /// Unit normal of the triangle, on the side of `wo`.
    pub geometric_normal: Vec3,
    /// Interpolated unit normal, on the side of `wo`.
    pub shading_normal: Vec3,
    /// Whether `wo` is on the triangle's front.
    pub front: bool,
    /// The triangle.
    pub triangle: u32,
    /// Index of its material.
    pub material: u32,
    /// Diffuse albedo or metal colour, textures applied.
    pub base_color: Vec3,
    /// Metalness, textures applied.
    pub metallic: f32,
    /// Perceptual roughness, textures applied.
    pub roughness: f32,
}

/// A hit, as far as its triangle alone says what it is.
struct Facet {
    /// Barycentric weights of the corners.
    weights: [f32; 3],
    position: Vec3,
    wo: Vec3,
    front: bool,
    geometric_normal: Vec3,
    shadow_origin: Vec3,
}

/// What a material is made of at one place, textures applied.
pub(crate) struct Appearance {
    pub(crate) base_color: Vec3,
    pub(crate) metallic: f32,
    pub(crate) roughness: f32,
}

/// Rounding, square roots and interpolation are single instructions with wider vectors.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn surface(scene: &Scene, ray: &Ray, hit: &Hit) -> Surface {
    scene.surface_at(ray, hit)
}

impl Scene {
    /// The surface at a hit of `ray`.
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        surface(self, ray, hit)
    }

    /// Where shadow rays start from a hit of `ray`: [`Surface::shadow_origin`] alone.
    #[must_use]
    pub fn shadow_origin(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        self.facet(ray, hit).shadow_origin
    }

    /// What of a hit needs no material.
    #[inline(always)]
    fn facet(&self, ray: &Ray, hit: &Hit) -> Facet {
        let shape = self.geometry.triangle(hit.triangle);
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let position = weights[0] * shape.a + weights[1] * shape.b + weights[2] * shape.c;
        let wo = -ray.direction.normalize_or(Vec3::NEG_Z);
        let front = shape.normal.dot(wo) >= 0.0;
        let geometric_normal = if front { shape.normal } else { -shape.normal };
        Facet {
            weights,
            position,
            wo,
            front,
            geometric_normal,
            shadow_origin: offset_origin(position, geometric_normal + wo, shape.extent()),
        }
    }

    #[inline(always)]
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> Surface {
        let corners = self.geometry.corners(hit.triangle);
        let Facet {
            weights,
            position,
            wo,
            front,
            geometric_normal,
            shadow_origin,
        } = self.facet(ray, hit);
        let interpolated = weights[0] * corners[0].normal
            + weights[1] * corners[1].normal
            + weights[2] * corners[2].normal;
        let mut shading_normal = interpolated.normalize_or(geometric_normal);
        if shading_normal.dot(geometric_normal) < 0.0 {
            shading_normal = -shading_normal;
        }
        let index = self.geometry.material_of(hit.triangle);
        let material = &self.materials[index as usize];
        let uv =
            weights[0] * corners[0].uv + weights[1] * corners[1].uv + weights[2] * corners[2].uv;
        let Appearance {
            base_color,
            metallic,
            roughness,
        } = self.appearance(material, uv);
        Surface {
            position,
            shadow_origin,
            wo,
            geometric_normal,
            shading_normal,
            front,
            triangle: hit.triangle,
            material: index,
            base_color,
            metallic,
            roughness,
        }
    }

    /// A material at a place in its textures.
    #[inline(always)]
    pub(crate) fn appearance(&self, material: &Material, uv: Vec2) -> Appearance {
        let mut base_color = material.base_color;
        if let Some(reference) = material.base_color_texture {
            base_color *= self.textures[reference.texture as usize]
                .sample(reference.map(uv))
                .truncate();
        }
        let (mut roughness, mut metallic) = (material.roughness, material.metallic);
        if let Some(reference) = material.metallic_roughness_texture {
            let texel = self.textures[reference.texture as usize].sample(reference.map(uv));
            roughness *= texel.y;
            metallic *= texel.z;
        }
        Appearance {
            base_color,
            metallic,
            roughness,
        }
    }

    /// Whether a triangle with a masked material is solid at barycentric weights `(u, v)`.
    /// Triangles of other materials always are.
    #[must_use]
    pub fn is_solid(&self, triangle: u32, u: f32, v: f32) -> bool {
        let material = &self.materials[self.geometry.material_of(triangle) as usize];
        let AlphaMode::Mask { cutoff } = material.alpha_mode else {
            return true;
        };
        let Some(reference) = material.base_color_texture else {
            return material.alpha >= cutoff;
        };
        let [a, b, c] = self.geometry.corners(triangle).map(|vertex| vertex.uv);
        let uv = (1.0 - u - v) * a + u * b + v * c;
        let texture = &self.textures[reference.texture as usize];
        material.alpha * texture.sample(reference.map(uv)).w >= cutoff
    }

    /// The material at a surface.
    #[must_use]
    pub fn material_at(&self, surface: &Surface) -> &Material {
        &self.materials[surface.material as usize]
    }
}
