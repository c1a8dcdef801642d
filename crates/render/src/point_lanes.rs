//! Surface points in lanes, and how they reflect. Each lane does what [`Brdf`] does for one
//! point, operation by operation, so the results are the same bits.

use std::f32::consts::PI;

use lie_accel::PACKET;
use lie_geom::{Aabb, RandomKey};
use lie_scene::Surface;
use multiversion::multiversion;

use crate::Brdf;

pub(crate) type Lanes = [f32; PACKET];

/// Radiance of each point, by channel.
pub(crate) type RadianceLanes = [Lanes; 3];

/// Up to sixteen surface points, one coordinate after the other.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct PointLanes {
    pub(crate) position: [Lanes; 3],
    /// Where shadow rays start.
    pub(crate) origin: [Lanes; 3],
    /// Box around those.
    pub(crate) origins: Aabb,
    pub(crate) normal: [Lanes; 3],
    pub(crate) geometric_normal: [Lanes; 3],
    wo: [Lanes; 3],
    pub(crate) diffuse: [Lanes; 3],
    f0: [Lanes; 3],
    f90: Lanes,
    /// GGX α, squared.
    alpha2: Lanes,
    cos_o: Lanes,
    /// What masking on the way to the eye has beside the light's cosine.
    root_o: Lanes,
    /// Whether any lane reflects more than Lambert.
    pub(crate) is_glossy: bool,
    /// Lanes that are so smooth that lights are followed along their lobe.
    pub(crate) smooth: u32,
    /// Lanes that reflect by Lambert's law alone.
    pub(crate) matt: u32,
    /// Each lane's random numbers.
    pub(crate) keys: [RandomKey; PACKET],
}

impl PointLanes {
    /// Nothing in any lane: no light reaches such a point.
    pub(crate) fn new() -> Self {
        let zero = [[0.0; PACKET]; 3];
        Self {
            position: zero,
            origin: zero,
            origins: Aabb::EMPTY,
            normal: zero,
            geometric_normal: zero,
            wo: zero,
            diffuse: zero,
            f0: zero,
            f90: [0.0; PACKET],
            alpha2: [1.0; PACKET],
            cos_o: [1.0; PACKET],
            root_o: [1.0; PACKET],
            is_glossy: false,
            smooth: 0,
            matt: 0,
            keys: [RandomKey::new(0); PACKET],
        }
    }

    /// Puts a point into a lane.
    pub(crate) fn set(&mut self, lane: usize, surface: &Surface, brdf: &Brdf, key: RandomKey) {
        self.origins = self.origins.union(Aabb::around([surface.shadow_origin]));
        for axis in 0..3 {
            self.position[axis][lane] = surface.position[axis];
            self.origin[axis][lane] = surface.shadow_origin[axis];
            self.normal[axis][lane] = brdf.normal[axis];
            self.geometric_normal[axis][lane] = brdf.geometric_normal[axis];
            self.wo[axis][lane] = brdf.wo[axis];
            self.diffuse[axis][lane] = brdf.diffuse[axis];
            self.f0[axis][lane] = brdf.f0[axis];
        }
        self.f90[lane] = brdf.f90;
        let a2 = brdf.alpha * brdf.alpha;
        self.alpha2[lane] = a2;
        self.cos_o[lane] = brdf.cos_o;
        self.root_o[lane] = (brdf.cos_o * brdf.cos_o * (1.0 - a2) + a2).sqrt();
        self.is_glossy |= !brdf.is_matt();
        self.smooth |= u32::from(brdf.is_smooth()) << lane;
        self.matt |= u32::from(brdf.is_matt()) << lane;
        self.keys[lane] = key;
    }
}

/// How a point reflects light from one direction.
pub(crate) struct Reflection {
    /// [`Brdf::parts`].
    pub(crate) diffuse: [f32; 3],
    pub(crate) specular: [f32; 3],
    /// [`Brdf::cosine`], 0 for none.
    pub(crate) cosine: f32,
    /// [`Brdf::specular_density`], if it was asked for.
    pub(crate) density: f32,
}

impl Reflection {
    /// [`Brdf::times_cosine`].
    #[inline(always)]
    pub(crate) fn times_cosine(&self, channel: usize) -> f32 {
        let value = (self.diffuse[channel] + self.specular[channel]) * self.cosine;
        // The lobe is undefined behind the surface.
        if self.cosine > 0.0 { value } else { 0.0 }
    }
}

impl PointLanes {
    /// Whether one lane's surface is turned to where a way, of any length, leads; in doubt it
    /// is.
    #[inline(always)]
    pub(crate) fn faces(&self, lane: usize, way: [f32; 3]) -> bool {
        let room = -1.0e-5 * (way[0].abs() + way[1].abs() + way[2].abs());
        (dot(self.at(&self.normal, lane), way) > room)
            & (dot(self.at(&self.geometric_normal, lane), way) > room)
    }

    /// One lane's reflection of light from `wi`, unit length. Without `GLOSSY` all lanes are
    /// Lambert; with `DENSITY` the lobe's density is found too.
    #[inline(always)]
    pub(crate) fn reflect<const GLOSSY: bool, const DENSITY: bool>(
        &self,
        lane: usize,
        wi: [f32; 3],
    ) -> Reflection {
        let normal = self.at(&self.normal, lane);
        let cos_i = dot(normal, wi);
        let faces = (cos_i > 0.0) & (dot(self.at(&self.geometric_normal, lane), wi) > 0.0);
        let (mut diffuse, mut specular) = (self.at(&self.diffuse, lane), [0.0; 3]);
        let mut density = 0.0;
        if GLOSSY {
            let (f0, f90) = (self.at(&self.f0, lane), self.f90[lane]);
            let lobe = self.lobe::<DENSITY>(lane, wi, cos_i);
            density = lobe.density;
            let matt = (f90 == 0.0) & (f0[0] == 0.0) & (f0[1] == 0.0) & (f0[2] == 0.0);
            for channel in 0..3 {
                let fresnel = f0[channel] + (f90 - f0[channel]) * lobe.grazing5;
                let under = diffuse[channel] * (1.0 - fresnel);
                diffuse[channel] = if matt { diffuse[channel] } else { under };
                specular[channel] = if matt { 0.0 } else { fresnel * lobe.height };
            }
        }
        Reflection {
            diffuse,
            specular,
            cosine: if faces { cos_i } else { 0.0 },
            density,
        }
    }

    #[inline(always)]
    fn lobe<const DENSITY: bool>(&self, lane: usize, wi: [f32; 3], cos_i: f32) -> Lobe {
        let (normal, wo) = (self.at(&self.normal, lane), self.at(&self.wo, lane));
        let sum = add(wi, wo);
        let reciprocal = 1.0 / dot(sum, sum).sqrt();
        let has_half = reciprocal < f32::INFINITY;
        let half = scale(sum, reciprocal);
        let half = [
            if has_half { half[0] } else { normal[0] },
            if has_half { half[1] } else { normal[1] },
            if has_half { half[2] } else { normal[2] },
        ];
        let grazing = 1.0 - smaller(larger(dot(wo, half), 0.0), 1.0);
        let grazing2 = grazing * grazing;
        let (a2, cos_o) = (self.alpha2[lane], self.cos_o[lane]);
        let masking_i = cos_o * (cos_i * cos_i * (1.0 - a2) + a2).sqrt();
        let masking_o = cos_i * self.root_o[lane];
        let towards = dot(normal, half);
        let cos_half = larger(towards, 0.0);
        let sine = cross(normal, half);
        let spread = cos_half * cos_half * a2 + dot(sine, sine);
        let mut density = 0.0;
        if DENSITY {
            let distribution = a2 / (PI * spread * spread);
            density = distribution * 0.5 / (cos_o + self.root_o[lane]);
            density = if towards <= 0.0 { 0.0 } else { density };
        }
        Lobe {
            grazing5: grazing2 * grazing2 * grazing,
            height: 0.5 * a2 / (PI * spread * spread * (masking_i + masking_o)),
            density,
        }
    }

    #[inline(always)]
    fn at(&self, axes: &[Lanes; 3], lane: usize) -> [f32; 3] {
        [axes[0][lane], axes[1][lane], axes[2][lane]]
    }
}

struct Lobe {
    /// The fifth power of the grazing angle's complement.
    grazing5: f32,
    /// The lobe without its Fresnel term.
    height: f32,
    density: f32,
}

/// Bits of the lanes that carry anything.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
pub(crate) fn carrying(radiance: &RadianceLanes) -> u32 {
    let mut lit = [0; PACKET];
    for lane in 0..PACKET {
        let any = (radiance[0][lane] > 0.0) | (radiance[1][lane] > 0.0) | (radiance[2][lane] > 0.0);
        lit[lane] = if any { 1 << lane } else { 0 };
    }
    // Halves onto each other: four vector operations.
    let mut width = PACKET;
    while width > 1 {
        width /= 2;
        for lane in 0..width {
            lit[lane] |= lit[lane + width];
        }
    }
    lit[0]
}

#[inline(always)]
pub(crate) fn subtract(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn scale(a: [f32; 3], factor: f32) -> [f32; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
