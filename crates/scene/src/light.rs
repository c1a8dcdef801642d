use glam::{Vec2, Vec3};
use lie_geom::{Aabb, Ray, Triangle, offset_origin, sampling::square_to_triangle};

/// A source of light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name from the file, for people.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// The kinds of light.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// An omnidirectional point.
    Point {
        /// Place.
        position: Vec3,
        /// W·sr⁻¹ in every direction.
        radiant_intensity: Vec3,
    },
    /// A point that shines into a cone; falls off from the inner to the outer angle as
    /// `KHR_lights_punctual` recommends.
    Spot {
        /// Place.
        position: Vec3,
        /// Axis of the cone, unit length, away from the light.
        direction: Vec3,
        /// W·sr⁻¹ inside the inner cone.
        radiant_intensity: Vec3,
        /// Cosine of the angle up to which the light is full; at least `cos_outer`.
        cos_inner: f32,
        /// Cosine of the angle from which on there is none.
        cos_outer: f32,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The way the light travels, unit length.
        direction: Vec3,
        /// W·m⁻² on a surface that faces the light.
        irradiance: Vec3,
    },
    /// A shining surface.
    Area(AreaLight),
}

/// A surface that gives off the same radiance everywhere and in every direction.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLight {
    /// Emitted radiance in W·sr⁻¹·m⁻².
    pub radiance: Vec3,
    /// Whether it shines from both sides; else only to where its normals point.
    pub double_sided: bool,
    shape: AreaShape,
    triangles: Vec<Triangle>,
    /// Area of all triangles up to and including this one, in m².
    cumulative_area: Vec<f32>,
    /// A sphere around it: centre and radius.
    sphere: (Vec3, f32),
}

/// The shapes of an area light.
#[derive(Clone, Debug, PartialEq)]
pub enum AreaShape {
    /// A parallelogram from a corner along two edges; shines along `edge_u × edge_v`.
    Rectangle {
        /// One corner.
        corner: Vec3,
        /// From the corner to its first neighbour.
        edge_u: Vec3,
        /// From the corner to its second neighbour.
        edge_v: Vec3,
    },
    /// Any number of triangles; they are *one* light, sampled by area.
    Mesh {
        /// The corners of each triangle.
        triangles: Vec<[Vec3; 3]>,
    },
}

/// What a surface point receives from one sample point of a light, if nothing blocks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Where the shadow ray ends: [`lie_geom::Ray::segment`] to here.
    pub target: Vec3,
    /// Direction to the light, unit length.
    pub wi: Vec3,
    /// Irradiance on a surface that faces the light, in W·m⁻²: the integrand times the
    /// inverse of the sampling density. Reflected radiance is `brdf · |cos θ| · this`.
    pub normal_irradiance: Vec3,
}

impl AreaLight {
    /// A light from its shape. Degenerate triangles count nothing.
    #[must_use]
    pub fn new(shape: AreaShape, radiance: Vec3, double_sided: bool) -> Self {
        let triangles: Vec<Triangle> = match &shape {
            &AreaShape::Rectangle {
                corner,
                edge_u,
                edge_v,
            } => {
                let far = corner + edge_u + edge_v;
                vec![
                    Triangle::new(corner, corner + edge_u, far),
                    Triangle::new(corner, far, corner + edge_v),
                ]
            }
            AreaShape::Mesh { triangles } => triangles
                .iter()
                .map(|&[a, b, c]| Triangle::new(a, b, c))
                .collect(),
        };
        let mut total = 0.0;
        let cumulative_area = triangles
            .iter()
            .map(|triangle| {
                total += if triangle.normal == Vec3::ZERO {
                    0.0
                } else {
                    f64::from(triangle.area())
                };
                total as f32
            })
            .collect();
        let corners = || {
            triangles
                .iter()
                .flat_map(|triangle| [triangle.a, triangle.b, triangle.c])
        };
        let center = Aabb::around(corners()).center();
        let radius = corners()
            .map(|corner| corner.distance(center))
            .fold(0.0, f32::max);
        Self {
            radiance,
            double_sided,
            shape,
            cumulative_area,
            sphere: (center, 1.001 * radius),
            triangles,
        }
    }

    /// The shape it was made from.
    #[must_use]
    pub fn shape(&self) -> &AreaShape {
        &self.shape
    }

    /// The shape as triangles.
    #[must_use]
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// One side's area in m².
    #[must_use]
    pub fn area(&self) -> f32 {
        self.cumulative_area.last().copied().unwrap_or(0.0)
    }

    /// A point on the light, uniform by area. `square` in `[0, 1)²` picks it. `None` for a
    /// light without area.
    #[must_use]
    #[inline]
    pub fn point(&self, square: Vec2) -> Option<LightPoint> {
        let (position, normal, extent) = match self.shape {
            AreaShape::Rectangle {
                corner,
                edge_u,
                edge_v,
            } => {
                let point = corner + square.x * edge_u + square.y * edge_v;
                let extent = edge_u.abs().max(edge_v.abs()).max_element();
                (point, self.triangles[0].normal, extent)
            }
            AreaShape::Mesh { .. } => {
                let wanted = square.x * self.area();
                let index = self.cumulative_area.partition_point(|&area| area <= wanted);
                let triangle = self.triangles.get(index)?;
                let before = if index == 0 {
                    0.0
                } else {
                    self.cumulative_area[index - 1]
                };
                let rescaled = (wanted - before) / (self.cumulative_area[index] - before);
                let weights = square_to_triangle(Vec2::new(rescaled.clamp(0.0, 1.0), square.y));
                let point = triangle.a
                    + weights.x * (triangle.b - triangle.a)
                    + weights.y * (triangle.c - triangle.a);
                (point, triangle.normal, triangle.extent())
            }
        };
        Some(LightPoint {
            position,
            normal,
            extent,
        })
    }

    /// Calls `found` with every point of the light along a ray of unit direction, whatever
    /// is in between.
    #[inline]
    pub fn points_along(&self, ray: &Ray, mut found: impl FnMut(LightPoint)) {
        let (center, radius) = self.sphere;
        let to_center = center - ray.origin;
        let along = to_center.dot(ray.direction);
        if to_center.length_squared() - along * along > radius * radius || along < -radius {
            return;
        }
        for triangle in &self.triangles {
            if let Some(hit) = triangle.intersect(ray) {
                found(LightPoint::on(triangle, ray.at(hit.t)));
            }
        }
    }
}

/// A point on an area light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Place.
    pub position: Vec3,
    /// Unit normal of the side that shines; with `double_sided` the other one does too.
    pub normal: Vec3,
    /// Longest edge of the triangle or rectangle that it lies on, in metres.
    extent: f32,
}

impl LightPoint {
    /// A place on one of a light's triangles.
    #[must_use]
    pub fn on(triangle: &Triangle, position: Vec3) -> Self {
        Self {
            position,
            normal: triangle.normal,
            extent: triangle.extent(),
        }
    }

    /// Longest edge of the triangle or rectangle that it lies on, in metres.
    #[must_use]
    #[inline]
    pub fn extent(&self) -> f32 {
        self.extent
    }

    /// What `point` sees of the light here: where a shadow ray must end, the direction to
    /// it (unit length), and the density per steradian there, in sr⁻¹, of points that are
    /// uniform over `light`'s area. `None` if it sees the dark side, or is at that very place.
    #[must_use]
    #[inline]
    pub fn seen_from(&self, point: Vec3, light: &AreaLight) -> Option<(Vec3, Vec3, f32)> {
        let to_light = self.position - point;
        let wi = to_light.try_normalize()?;
        let mut cosine = -wi.dot(self.normal);
        let mut normal = self.normal;
        if light.double_sided && cosine < 0.0 {
            (cosine, normal) = (-cosine, -normal);
        }
        let density = to_light.length_squared() / (cosine * light.area());
        (cosine > 0.0).then(|| {
            (
                offset_origin(self.position, normal, self.extent),
                wi,
                density,
            )
        })
    }
}

impl Light {
    /// Whether one sample is all there is to know: the light has no extent.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        !matches!(self.kind, LightKind::Area(_))
    }

    /// The light's total power in W, per channel; for a directional light its irradiance,
    /// since its power depends on the scene.
    #[must_use]
    pub fn power(&self) -> Vec3 {
        use std::f32::consts::PI;
        match &self.kind {
            LightKind::Point {
                radiant_intensity, ..
            } => 4.0 * PI * *radiant_intensity,
            LightKind::Spot {
                radiant_intensity,
                cos_inner,
                cos_outer,
                ..
            } => {
                // The squared ramp between the cosines integrates to a third of its width.
                2.0 * PI * *radiant_intensity * ((1.0 - cos_inner) + (cos_inner - cos_outer) / 3.0)
            }
            LightKind::Directional { irradiance, .. } => *irradiance,
            LightKind::Area(area) => {
                PI * area.radiance * area.area() * if area.double_sided { 2.0 } else { 1.0 }
            }
        }
    }

    /// Samples what `point` receives. `square` in `[0, 1)²` picks the place on an area
    /// light; lights without extent ignore it. `reach` is a distance in metres that is
    /// outside the scene from everywhere in it, for directional lights.
    ///
    /// `None` where the light gives nothing: outside its cone, behind it, or at its very place.
    #[must_use]
    #[inline]
    pub fn sample(&self, point: Vec3, square: Vec2, reach: f32) -> Option<LightSample> {
        match &self.kind {
            LightKind::Point {
                position,
                radiant_intensity,
            } => from_point(point, *position, *radiant_intensity),
            LightKind::Spot {
                position,
                direction,
                radiant_intensity,
                cos_inner,
                cos_outer,
            } => {
                let sample = from_point(point, *position, *radiant_intensity)?;
                let falloff = spot_falloff(-sample.wi.dot(*direction), *cos_inner, *cos_outer);
                (falloff > 0.0).then(|| LightSample {
                    normal_irradiance: sample.normal_irradiance * falloff,
                    ..sample
                })
            }
            LightKind::Directional {
                direction,
                irradiance,
            } => Some(LightSample {
                target: point - *direction * reach,
                wi: -*direction,
                normal_irradiance: *irradiance,
            }),
            LightKind::Area(area) => {
                let (target, wi, density) = area.point(square)?.seen_from(point, area)?;
                Some(LightSample {
                    target,
                    wi,
                    normal_irradiance: area.radiance / density,
                })
            }
        }
    }
}

#[inline]
fn from_point(point: Vec3, position: Vec3, radiant_intensity: Vec3) -> Option<LightSample> {
    let to_light = position - point;
    let reciprocal = to_light.length_recip();
    (reciprocal > 0.0 && reciprocal.is_finite()).then(|| LightSample {
        target: position,
        wi: to_light * reciprocal,
        normal_irradiance: radiant_intensity * (reciprocal * reciprocal),
    })
}

/// By how much the ramp of a spot's soft edge rises per unit of the cosine.
#[must_use]
#[inline]
pub fn ramp_slope(cos_inner: f32, cos_outer: f32) -> f32 {
    1.0 / (cos_inner - cos_outer).max(1.0e-4)
}

/// `KHR_lights_punctual`: the square of a ramp between the cosines.
#[inline]
fn spot_falloff(cosine: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    if cosine <= cos_outer {
        return 0.0;
    }
    let ramp = ((cosine - cos_outer) * ramp_slope(cos_inner, cos_outer)).min(1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests {
    use super::*;
    use lie_geom::sampling::stratified;

    #[test]
    fn a_mesh_light_is_sampled_by_area() {
        // A large and a small triangle, ten to one: the points follow.
        let small = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let large = [Vec3::Z, Vec3::Z + 10.0 * Vec3::X, Vec3::Z + Vec3::Y];
        let shape = AreaShape::Mesh {
            triangles: vec![small, large, [Vec3::ZERO; 3]],
        };
        let light = AreaLight::new(shape, Vec3::ONE, false);
        assert!((light.area() - 5.5).abs() < 1.0e-5);
        let n = 64;
        let on_small = (0..n * n)
            .filter(|&i| {
                light
                    .point(stratified((n, n), i, Vec2::splat(0.5)))
                    .unwrap()
                    .position
                    .z
                    < 0.5
            })
            .count();
        assert!((on_small as f32 / (n * n) as f32 - 1.0 / 11.0).abs() < 0.02);
    }

    #[test]
    fn the_spot_ends_at_its_outer_angle() {
        let light = Light {
            name: String::new(),
            kind: LightKind::Spot {
                position: Vec3::ZERO,
                direction: Vec3::NEG_Y,
                radiant_intensity: Vec3::ONE,
                cos_inner: 0.3f32.cos(),
                cos_outer: 0.5f32.cos(),
            },
        };
        let at = |angle: f32| {
            let point = 2.0 * Vec3::new(angle.sin(), -angle.cos(), 0.0);
            light
                .sample(point, Vec2::ZERO, 1.0)
                .map(|s| s.normal_irradiance.x)
        };
        assert!((at(0.0).unwrap() - 0.25).abs() < 1.0e-6);
        assert!((at(0.299).unwrap() - 0.25).abs() < 1.0e-4);
        assert!(at(0.4).unwrap() < 0.25 && at(0.4).unwrap() > 0.0);
        assert_eq!(at(0.501), None);
        assert_eq!(at(3.0), None);
    }

    #[test]
    fn degenerate_lights_give_nothing_instead_of_nonsense() {
        let empty = AreaLight::new(AreaShape::Mesh { triangles: vec![] }, Vec3::ONE, true);
        let flat = AreaLight::new(
            AreaShape::Mesh {
                triangles: vec![[Vec3::X; 3]],
            },
            Vec3::ONE,
            true,
        );
        for kind in [
            LightKind::Area(empty),
            LightKind::Area(flat),
            LightKind::Point {
                position: Vec3::ZERO,
                radiant_intensity: Vec3::ONE,
            },
        ] {
            let light = Light {
                name: String::new(),
                kind,
            };
            assert_eq!(light.sample(Vec3::ZERO, Vec2::splat(0.5), 1.0), None);
        }
    }
}
