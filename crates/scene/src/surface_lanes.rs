//! Surfaces at sixteen hits of rays from one place. Each lane does what [`Scene::surface`] does
//! for one hit, operation by operation, so the results are the same bits.

use glam::{Vec2, Vec3};
use lie_geom::{Hit, OFFSET_ULPS, dot};
use multiversion::multiversion;

use crate::{Scene, Surface};

/// Hits at a time.
pub const SURFACE_LANES: usize = 16;

pub(crate) type Lanes = [f32; SURFACE_LANES];

/// [`Surface`]s, one coordinate after the other. Those of lanes without a hit are turned nowhere.
/// Lanes come first: no vector lies across two cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct SurfaceLanes {
    /// As of [`Surface::position`].
    pub position: [Lanes; 3],
    /// As of [`Surface::shadow_origin`].
    pub shadow_origin: [Lanes; 3],
    /// As of [`Surface::wo`].
    pub wo: [Lanes; 3],
    /// As of [`Surface::geometric_normal`].
    pub geometric_normal: [Lanes; 3],
    /// As of [`Surface::shading_normal`].
    pub shading_normal: [Lanes; 3],
    /// As of [`Surface::triangle`].
    pub triangle: [u32; SURFACE_LANES],
    /// As of [`Surface::material`].
    pub material: [u32; SURFACE_LANES],
    /// As of [`Surface::base_color`].
    pub base_color: [Lanes; 3],
    /// As of [`Surface::metallic`].
    pub metallic: Lanes,
    /// As of [`Surface::roughness`].
    pub roughness: Lanes,
    /// The lanes that hit something: bit `i` for lane `i`. The rest is theirs alone.
    pub hits: u32,
    /// As of [`Surface::front`]: bit `i` for lane `i`.
    pub front: u32,
}

/// What of hits is fetched from all over the scene.
#[repr(C, align(64))]
struct Fetched {
    weights: [Lanes; 3],
    corners: [[Lanes; 3]; 3],
    normal: [Lanes; 3],
    normals: [[Lanes; 3]; 3],
}

impl Default for SurfaceLanes {
    fn default() -> Self {
        let zero = [[0.0; SURFACE_LANES]; 3];
        Self {
            hits: 0,
            position: zero,
            shadow_origin: zero,
            wo: zero,
            geometric_normal: zero,
            shading_normal: zero,
            front: 0,
            triangle: [0; SURFACE_LANES],
            material: [0; SURFACE_LANES],
            base_color: zero,
            metallic: [0.0; SURFACE_LANES],
            roughness: [0.0; SURFACE_LANES],
        }
    }
}

impl SurfaceLanes {
    /// The surface in one lane that hit something.
    #[must_use]
    pub fn surface(&self, lane: usize) -> Surface {
        let at = |axes: &[Lanes; 3]| Vec3::new(axes[0][lane], axes[1][lane], axes[2][lane]);
        Surface {
            position: at(&self.position),
            shadow_origin: at(&self.shadow_origin),
            wo: at(&self.wo),
            geometric_normal: at(&self.geometric_normal),
            shading_normal: at(&self.shading_normal),
            front: self.front >> lane & 1 == 1,
            triangle: self.triangle[lane],
            material: self.material[lane],
            base_color: at(&self.base_color),
            metallic: self.metallic[lane],
            roughness: self.roughness[lane],
        }
    }
}

impl Scene {
    /// Makes `surfaces` those at hits of rays with these directions.
    pub fn surfaces(
        &self,
        directions: &[[f32; SURFACE_LANES]; 3],
        hits: &[Option<Hit>; SURFACE_LANES],
        surfaces: &mut SurfaceLanes,
    ) {
        let zero = [[0.0; SURFACE_LANES]; 3];
        surfaces.hits = 0;
        let mut fetched = Fetched {
            weights: zero,
            corners: [zero; 3],
            normal: zero,
            normals: [zero; 3],
        };
        for (lane, hit) in hits.iter().enumerate() {
            let Some(hit) = hit else { continue };
            surfaces.hits |= 1 << lane;
            surfaces.triangle[lane] = hit.triangle;
            let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
            let shape = self.geometry.triangle(hit.triangle);
            let vertices = self.geometry.corners(hit.triangle);
            for axis in 0..3 {
                fetched.weights[axis][lane] = weights[axis];
                fetched.corners[0][axis][lane] = shape.a[axis];
                fetched.corners[1][axis][lane] = shape.b[axis];
                fetched.corners[2][axis][lane] = shape.c[axis];
                fetched.normal[axis][lane] = shape.normal[axis];
                for corner in 0..3 {
                    fetched.normals[corner][axis][lane] = vertices[corner].normal[axis];
                }
            }
            let [a, b, c] = vertices.map(|vertex| vertex.uv);
            self.look(
                surfaces,
                lane,
                weights[0] * a + weights[1] * b + weights[2] * c,
            );
        }
        place(surfaces, &fetched, directions);
    }

    /// What a lane's material, at a place in its textures, is made of.
    #[inline]
    fn look(&self, surfaces: &mut SurfaceLanes, lane: usize, uv: Vec2) {
        let index = self.geometry.material_of(surfaces.triangle[lane]);
        let appearance = self.appearance(&self.materials[index as usize], uv);
        surfaces.material[lane] = index;
        for channel in 0..3 {
            surfaces.base_color[channel][lane] = appearance.base_color[channel];
        }
        surfaces.metallic[lane] = appearance.metallic;
        surfaces.roughness[lane] = appearance.roughness;
    }
}

/// Where the hits are, and how surfaces are turned there.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn place(surfaces: &mut SurfaceLanes, fetched: &Fetched, directions: &[Lanes; 3]) {
    let mut front = [0u32; SURFACE_LANES];
    for lane in 0..SURFACE_LANES {
        let weights = at(&fetched.weights, lane);
        let [a, b, c] = [
            at(&fetched.corners[0], lane),
            at(&fetched.corners[1], lane),
            at(&fetched.corners[2], lane),
        ];
        let position = weighted(weights, [a, b, c]);
        let way = unit_or(at(directions, lane), [0.0, 0.0, -1.0]);
        let wo = [-way[0], -way[1], -way[2]];
        let normal = at(&fetched.normal, lane);
        let is_front = dot(normal, wo) >= 0.0;
        let geometric = turned(normal, is_front);
        let longest = larger(squared(c, b), squared(a, c));
        let extent = larger(squared(b, a), longest).sqrt();
        let reach = larger(
            position[0].abs(),
            larger(position[1].abs(), position[2].abs()),
        );
        let off = OFFSET_ULPS * (reach + extent);
        let normals = [
            at(&fetched.normals[0], lane),
            at(&fetched.normals[1], lane),
            at(&fetched.normals[2], lane),
        ];
        let shading = unit_or(weighted(weights, normals), geometric);
        let shading = turned(shading, dot(shading, geometric) >= 0.0);
        front[lane] = if is_front { 1 << lane } else { 0 };
        for axis in 0..3 {
            surfaces.position[axis][lane] = position[axis];
            surfaces.shadow_origin[axis][lane] =
                position[axis] + (geometric[axis] + wo[axis]) * off;
            surfaces.wo[axis][lane] = wo[axis];
            surfaces.geometric_normal[axis][lane] = geometric[axis];
            surfaces.shading_normal[axis][lane] = shading[axis];
        }
    }
    surfaces.front = front.iter().fold(0, |all, bit| all | bit) & surfaces.hits;
}

#[inline(always)]
fn at(axes: &[Lanes; 3], lane: usize) -> [f32; 3] {
    [axes[0][lane], axes[1][lane], axes[2][lane]]
}

#[inline(always)]
fn weighted(weights: [f32; 3], [a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for axis in 0..3 {
        sum[axis] = weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis];
    }
    sum
}

/// [`Vec3::normalize_or`].
#[inline(always)]
pub(crate) fn unit_or(vector: [f32; 3], fallback: [f32; 3]) -> [f32; 3] {
    let reciprocal = 1.0 / dot(vector, vector).sqrt();
    let is_good = (reciprocal < f32::INFINITY) & (reciprocal > 0.0);
    let mut unit = [0.0; 3];
    for axis in 0..3 {
        unit[axis] = if is_good {
            vector[axis] * reciprocal
        } else {
            fallback[axis]
        };
    }
    unit
}

#[inline(always)]
fn turned(vector: [f32; 3], stays: bool) -> [f32; 3] {
    let mut turned = [0.0; 3];
    for axis in 0..3 {
        turned[axis] = if stays { vector[axis] } else { -vector[axis] };
    }
    turned
}

#[inline(always)]
fn squared(a: [f32; 3], b: [f32; 3]) -> f32 {
    let way = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dot(way, way)
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use lie_geom::{RandomKey, Ray};

    use super::*;
    use crate::{Gallery, gallery};

    #[test]
    fn lanes_do_what_the_scalar_code_does() {
        let scene = gallery(&Gallery {
            detail: 0.1,
            ..Gallery::default()
        });
        let triangles = scene.geometry.len() as f32;
        let camera = &scene.cameras[0];
        for round in 0..200 {
            let key = RandomKey::new(round);
            let mut directions = [[0.0; SURFACE_LANES]; 3];
            let mut rays = vec![];
            let hits = std::array::from_fn(|lane| {
                let (film, place) = (key.uniform2(lane as u32), key.uniform2(100 + lane as u32));
                let ray = camera.ray(film * 64.0, UVec2::splat(64));
                for axis in 0..3 {
                    directions[axis][lane] = ray.direction[axis];
                }
                rays.push(ray);
                // Any point of any triangle will do.
                let hit = Hit {
                    t: 1.0,
                    u: place.x * 0.5,
                    v: place.y * 0.5,
                    triangle: (key.uniform(200 + lane as u32) * triangles) as u32,
                };
                (lane as u64 % 7 != round % 7).then_some(hit)
            });
            let mut lanes = SurfaceLanes::default();
            scene.surfaces(&directions, &hits, &mut lanes);
            for (lane, (hit, ray)) in hits.iter().zip(&rays).enumerate() {
                let ray: &Ray = ray;
                assert_eq!(lanes.hits >> lane & 1 == 1, hit.is_some());
                if let Some(hit) = hit {
                    assert_eq!(lanes.surface(lane), scene.surface(ray, hit));
                }
            }
        }
    }
}
