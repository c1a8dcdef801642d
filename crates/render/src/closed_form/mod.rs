//! What an area light gives a surface that reflects by Lambert's law, if nothing is in the way:
//! Lambert's own formula (1760), half the sum over a polygon's edges of the angle that each
//! subtends times the cosine between the normal and the plane through edge and point.

mod clip;
mod edge;
mod frame;
mod lanes;
mod outline;

use glam::{DVec3, Vec3};
use lie_scene::{AreaLight, LightPoint};

pub(crate) use self::frame::NEAR;
use self::{
    clip::{clipped_middle, clipped_terms},
    edge::{Vector, dot, edge_term, larger, subtract},
    frame::Frame,
    outline::{Outline, outlines},
};

/// Edges up to which a light is integrated: as many take less time than 64 sample points, by
/// four times on a mesh (decision 29). Lights of more are sampled alone.
const MAX_EDGES: usize = 64;

/// Irradiance from a light of radiance 1, in sr, below which it is not worth a ray of its own.
pub(crate) const LEAST: f32 = 1.0e-9;

/// An area light as the outlines of its flat parts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outlines {
    outlines: Vec<Outline>,
    double_sided: bool,
    edges: usize,
    frame: Frame,
}

/// Where light arrives.
#[derive(Clone, Copy)]
struct At {
    position: Vector,
    normal: Vector,
    geometric_normal: Vector,
}

impl At {
    fn new(position: Vec3, normal: Vec3, geometric_normal: Vec3) -> Self {
        let [position, normal, geometric_normal] =
            [position, normal, geometric_normal].map(|vector| vector.as_dvec3().to_array());
        Self {
            position,
            normal,
            geometric_normal,
        }
    }
}

impl Outlines {
    /// `None` for a light without area, and for one of so many edges that samples cost less.
    pub(crate) fn new(light: &AreaLight) -> Option<Self> {
        let outlines = outlines(light.triangles());
        let edges = outlines.iter().map(Outline::edges).sum();
        (1..=MAX_EDGES).contains(&edges).then_some(Self {
            outlines,
            double_sided: light.double_sided,
            edges,
            frame: Frame::around(light),
        })
    }

    /// Edges of all outlines.
    pub(crate) fn edges(&self) -> usize {
        self.edges
    }

    /// Irradiance from the light, were its radiance 1, by the cosine to `normal`, in sr: what is
    /// behind `normal` or `geometric_normal` gives nothing, and neither does what is seen
    /// from its dark side. Relative error below 10⁻⁶ but for rounding of what is given; never
    /// negative.
    pub(crate) fn irradiance(&self, position: Vec3, normal: Vec3, geometric_normal: Vec3) -> f32 {
        let at = At::new(position, normal, geometric_normal);
        let mut sum = 0.0;
        for outline in &self.outlines {
            sum += self.one(outline, &at);
        }
        sum as f32
    }

    /// Whether every point of the light is at least so far from a point that none of `samples`
    /// sample points is near ([`crate::LightRay::exact`]).
    pub(crate) fn is_far(&self, position: Vec3, samples: u32) -> bool {
        self.frame.is_far(position.to_array(), samples as f32)
    }

    /// A point of the light that shines above both horizons, in the middle of what gives most.
    /// `None` if hardly anything does.
    #[cold]
    pub(crate) fn some_point(
        light: &AreaLight,
        position: Vec3,
        normal: Vec3,
        geometric_normal: Vec3,
    ) -> Option<LightPoint> {
        let at = At::new(position, normal, geometric_normal);
        let mut most = f64::from(LEAST);
        let mut found = None;
        for triangle in light.triangles() {
            let Some(outline) = Outline::of_triangle(triangle) else {
                continue;
            };
            let side = side(&outline, at.position, light.double_sided);
            let (terms, middle) = clipped_middle(&outline.loops[0], &at);
            if side * terms > most {
                most = side * terms;
                found = middle.map(|middle| {
                    let place = position.as_dvec3() + DVec3::from(middle);
                    LightPoint::on(triangle, place.as_vec3())
                });
            }
        }
        found
    }

    fn one(&self, outline: &Outline, at: &At) -> f64 {
        let side = side(outline, at.position, self.double_sided);
        if side == 0.0 {
            return 0.0;
        }
        let heights = |normal: Vector| {
            let heights = outline.loops.iter().flatten();
            let heights = heights.map(|&corner| dot(normal, subtract(corner, at.position)));
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
                (low.min(height), high.max(height))
            })
        };
        let (lowest, highest) = heights(at.normal);
        let (lowest_flat, highest_flat) = heights(at.geometric_normal);
        if highest <= 0.0 || highest_flat <= 0.0 {
            return 0.0;
        }
        if lowest < 0.0 || lowest_flat < 0.0 {
            return self.cut(outline, at);
        }
        let mut terms = 0.0;
        for corners in &outline.loops {
            let end_of = |corner: Vector| {
                let corner = subtract(corner, at.position);
                (corner, dot(corner, corner).sqrt())
            };
            let mut last = end_of(corners[corners.len() - 1]);
            for &corner in corners {
                let end = end_of(corner);
                terms += edge_term(at.normal, last, end);
                last = end;
            }
        }
        larger(side * terms, 0.0)
    }

    /// The same of an outline that the horizon may cut.
    fn cut(&self, outline: &Outline, at: &At) -> f64 {
        let mut terms = 0.0;
        for corners in &outline.loops {
            terms += clipped_terms(corners, at);
        }
        larger(side(outline, at.position, self.double_sided) * terms, 0.0)
    }
}

/// What the sum of an outline's edges is to be multiplied by, for a point on this side of it: 0
/// where nothing shines to.
#[inline(always)]
fn side(outline: &Outline, point: Vector, double_sided: bool) -> f64 {
    let height = dot(outline.normal, subtract(point, outline.corner()));
    // Seen from the front, corners that go round counter-clockwise go round the way there
    // clockwise.
    if height > 0.0 {
        -0.5
    } else if (height < 0.0) & double_sided {
        0.5
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
