use glam::{Vec2, Vec3};
use lie_geom::{Aabb, OFFSET_ULPS, Ray, Triangle, offset_origin, sampling::square_to_triangle};

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
    ends: Aabb,
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
        let bounds = Aabb::around(corners());
        let center = bounds.center();
        let radius = corners()
            .map(|corner| corner.distance(center))
            .fold(0.0, f32::max);
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        // What [`offset_origin`] adds, and room for rounding.
        let room = Vec3::splat(4.0 * OFFSET_ULPS * (reach + 2.0 * radius));
        Self {
            radiance,
            double_sided,
            shape,
            cumulative_area,
            sphere: (center, 1.001 * radius),
            ends: Aabb {
                min: bounds.min - room,
                max: bounds.max + room,
            },
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

    /// A box around all places where shadow rays to it end: [`LightSample::target`](crate::LightSample::target).
    #[must_use]
    #[inline]
    pub fn ends(&self) -> Aabb {
        self.ends
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

#[cfg(test)]
mod tests {
    use super::*;
    use lie_geom::sampling::stratified;

    #[test]
    fn shadow_rays_end_in_the_box_of_ends() {
        let corner = Vec3::new(1000.0, -0.01, 3.0);
        let rectangle = AreaShape::Rectangle {
            corner,
            edge_u: Vec3::new(0.7, 0.0, -1.3),
            edge_v: Vec3::new(0.1, 0.0, 0.9),
        };
        let shapes = [
            rectangle,
            AreaShape::Mesh {
                triangles: vec![[corner, corner + Vec3::X, corner + 30.0 * Vec3::Z]],
            },
        ];
        let mut seen = 0;
        for shape in shapes {
            let light = AreaLight::new(shape, Vec3::ONE, true);
            let n = 16;
            for index in 0..n * n {
                let jitter = Vec2::new((index % 3) as f32, (index / 3 % 3) as f32) * 0.499_99;
                let point = light
                    .point(stratified((n, n), index, jitter))
                    .expect("a point");
                for from in [Vec3::ZERO, corner + Vec3::Y, corner - Vec3::Y] {
                    if let Some((target, ..)) = point.seen_from(from, &light) {
                        seen += 1;
                        assert!(
                            light.ends().contains(target),
                            "{target} of {:?}",
                            light.ends()
                        );
                    }
                }
            }
        }
        assert!(seen > 1000, "{seen} places");
    }

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
}
