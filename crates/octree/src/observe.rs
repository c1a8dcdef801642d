use glam::Vec3;
use lie_geom::{Aabb, RandomKey, Ray};

/// What construction needs to know of the world. Rays come in groups of at most [`GROUP`].
pub trait Visibility: Sync {
    /// A group of rays in the form that is fastest to ask.
    type Rays;

    /// Puts rays into that form.
    fn gather(&self, rays: &[Ray]) -> Self::Rays;

    /// For each ray some triangle of the whole scene that blocks it.
    fn blockers(&self, rays: &Self::Rays) -> [Option<u32>; GROUP];

    /// Which rays this triangle blocks: bit `i` for ray `i`.
    fn blocked_by(&self, triangle: u32, rays: &Self::Rays) -> u32;

    /// Adds triangles that are likely to be near this one.
    fn neighbours(&self, triangle: u32, found: &mut Vec<u32>);

    /// A ray from a point, or from the surface close to it, to a light that goes by way of a
    /// random place on a triangle, if it could carry light; and its end at the surface.
    fn aim(&self, point: u32, triangle: u32, light: u32, random: RandomKey) -> Option<(Ray, Vec3)>;
}

/// What can come between lights and cells at all, by the scene's geometry.
pub trait Between {
    /// Tells which triangles may block a ray from somewhere in a box to a light.
    fn between(&self, light: u32, ends: Aabb) -> impl Fn(u32) -> bool;
}

/// Nothing is known of the geometry: everything may come between.
impl Between for () {
    fn between(&self, _light: u32, _ends: Aabb) -> impl Fn(u32) -> bool {
        |_| true
    }
}

/// Rays that are asked together.
pub const GROUP: usize = 16;

/// A ray between a surface point and a random point on a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowRay {
    /// Which of the points.
    pub point: u32,
    /// The segment between the two, from either end.
    pub ray: Ray,
    /// What it would add to the pixel if nothing blocked it, as luminance.
    pub weight: f32,
    /// What rays from the same point to the same light would add that are not among those
    /// observed, since shaders trace them through the scene wherever the light is not hidden.
    pub beside: f32,
}

/// One sample of LIE §4.1: what a point sees of the lights that could light it.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The point.
    pub point: Vec3,
    /// What the rays to the lights met, light by light.
    pub outcomes: Vec<Outcome>,
    /// Luminance of the pixel as the tree stood when it was observed, masking left aside.
    pub predicted: f32,
    /// Luminance of the pixel as it is.
    pub actual: f32,
    /// Lights that could light the point.
    pub evaluations: u32,
    /// How many of them shaders do not ask the scene for.
    pub trusted: u32,
}

impl Observation {
    /// An observation that saw nothing yet.
    #[must_use]
    pub fn at(point: Vec3) -> Self {
        Self {
            point,
            outcomes: vec![],
            predicted: 0.0,
            actual: 0.0,
            evaluations: 0,
            trusted: 0,
        }
    }
}

/// What some rays from one point to one light met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Number of the light.
    pub light: u32,
    /// What is in the way, if anything.
    pub blocker: Option<u32>,
    /// How many rays.
    pub rays: u32,
    /// What the light would give, unoccluded, as a share of what the pixel or a typical
    /// one shows; in `[0, 1]`.
    pub importance: f32,
    /// What they add to the pixel, as luminance: nothing where something is in the way.
    pub luminance: f32,
    /// What they would add if nothing were in the way, as luminance: 0 where nothing is.
    pub withheld: f32,
    /// [`ShadowRay::beside`].
    pub beside: f32,
}

impl Outcome {
    /// One ray that reached a light and carried nothing.
    #[must_use]
    pub fn of(light: u32) -> Self {
        Self {
            light,
            blocker: None,
            rays: 1,
            importance: 0.0,
            luminance: 0.0,
            withheld: 0.0,
            beside: 0.0,
        }
    }
}
