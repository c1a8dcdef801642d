//! Surface points in lanes, and how they reflect. Each lane does what [`Brdf`] does for one
//! point, operation by operation, so the results are the same bits.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;
use lie_accel::PACKET;
use lie_geom::{Aabb, RandomKey};
#[cfg(test)]
use lie_scene::Surface;
use lie_scene::{Scene, SurfaceLanes};
use multiversion::multiversion;

use crate::Brdf;

pub(crate) type Lanes = [f32; PACKET];

/// Radiance of each point, by channel.
pub(crate) type RadianceLanes = [Lanes; 3];

/// Up to sixteen surface points, one coordinate after the other: the lanes first, in this order, so
/// that no vector lies across two cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct PointLanes {
    pub(crate) position: [Lanes; 3],
    /// Where shadow rays start.
    pub(crate) origin: [Lanes; 3],
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
    /// Box around where shadow rays start.
    pub(crate) origins: Aabb,
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

    /// Makes these the points at some surfaces; lanes without one have nothing.
    pub(crate) fn look(
        &mut self,
        scene: &Scene,
        surfaces: &SurfaceLanes,
        keys: &[RandomKey; PACKET],
    ) {
        let mut specular = [0.0; PACKET];
        self.origins = Aabb::EMPTY;
        for lane in (0..PACKET).filter(|lane| surfaces.hits >> lane & 1 == 1) {
            specular[lane] = scene.materials[surfaces.material[lane] as usize].specular;
            let origin = &surfaces.shadow_origin;
            let origin = Vec3::new(origin[0][lane], origin[1][lane], origin[2][lane]);
            self.origins = self.origins.union(Aabb::around([origin]));
        }
        self.position = surfaces.position;
        self.origin = surfaces.shadow_origin;
        self.normal = surfaces.shading_normal;
        self.geometric_normal = surfaces.geometric_normal;
        self.wo = surfaces.wo;
        self.keys = *keys;
        reflect_as(self, surfaces, &specular);
    }

    /// Has nothing in the lanes from `first` on, and forgets what it knew of all lanes together.
    pub(crate) fn clear(&mut self, first: usize) {
        for axis in 0..3 {
            self.normal[axis][first..].fill(0.0);
            self.geometric_normal[axis][first..].fill(0.0);
        }
        self.origins = Aabb::EMPTY;
        (self.is_glossy, self.smooth, self.matt) = (false, 0, 0);
    }

    /// Puts a point of another group into a lane.
    #[inline]
    pub(crate) fn copy(&mut self, lane: usize, from: &Self, point: usize) {
        let axes = |to: &mut [Lanes; 3], from: &[Lanes; 3]| {
            for axis in 0..3 {
                to[axis][lane] = from[axis][point];
            }
        };
        axes(&mut self.position, &from.position);
        axes(&mut self.origin, &from.origin);
        axes(&mut self.normal, &from.normal);
        axes(&mut self.geometric_normal, &from.geometric_normal);
        axes(&mut self.wo, &from.wo);
        axes(&mut self.diffuse, &from.diffuse);
        axes(&mut self.f0, &from.f0);
        self.f90[lane] = from.f90[point];
        self.alpha2[lane] = from.alpha2[point];
        self.cos_o[lane] = from.cos_o[point];
        self.root_o[lane] = from.root_o[point];
        self.smooth |= (from.smooth >> point & 1) << lane;
        self.matt |= (from.matt >> point & 1) << lane;
        self.is_glossy |= from.matt >> point & 1 == 0;
        self.keys[lane] = from.keys[point];
        let origin = &self.origin;
        let origin = Vec3::new(origin[0][lane], origin[1][lane], origin[2][lane]);
        self.origins = self.origins.union(Aabb::around([origin]));
    }

    /// Puts a point into a lane.
    #[cfg(test)]
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

/// Works out how surfaces reflect, as [`Brdf::new`] does.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn reflect_as(points: &mut PointLanes, surfaces: &SurfaceLanes, specular: &Lanes) {
    let (mut matt, mut smooth) = ([0u32; PACKET], [0u32; PACKET]);
    for lane in 0..PACKET {
        let (metallic, specular) = (surfaces.metallic[lane], specular[lane]);
        let mut is_matt = true;
        for channel in 0..3 {
            let color = surfaces.base_color[channel][lane];
            let f0 = 0.04 * specular * (1.0 - metallic) + color * metallic;
            points.diffuse[channel][lane] = color * (1.0 - metallic) * FRAC_1_PI;
            points.f0[channel][lane] = f0;
            is_matt &= f0 == 0.0;
        }
        let f90 = specular + (1.0 - specular) * metallic;
        is_matt &= f90 == 0.0;
        let roughness = surfaces.roughness[lane];
        let alpha = larger(roughness * roughness, Brdf::MIN_ALPHA);
        let (a2, cos_o) = (
            alpha * alpha,
            dot(points.at(&points.normal, lane), points.at(&points.wo, lane)),
        );
        let cos_o = larger(cos_o, Brdf::MIN_COSINE);
        points.f90[lane] = f90;
        points.alpha2[lane] = a2;
        points.cos_o[lane] = cos_o;
        points.root_o[lane] = (cos_o * cos_o * (1.0 - a2) + a2).sqrt();
        matt[lane] = if is_matt { 1 << lane } else { 0 };
        let is_smooth = (alpha < Brdf::SMOOTH_ALPHA) & !is_matt;
        smooth[lane] = if is_smooth { 1 << lane } else { 0 };
    }
    points.matt = matt.iter().fold(0, |all, bit| all | bit) & surfaces.hits;
    points.smooth = smooth.iter().fold(0, |all, bit| all | bit) & surfaces.hits;
    points.is_glossy = points.matt != surfaces.hits;
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::UVec2;
    use lie_geom::Ray;
    use lie_scene::{Gallery, gallery};

    use super::*;
    use crate::World;

    #[test]
    fn surfaces_reflect_in_lanes_as_they_do_one_by_one() {
        let parameters = Gallery {
            detail: 0.1,
            ..Gallery::default()
        };
        let world = World::new(Arc::new(gallery(&parameters)));
        let scene = world.scene();
        let film = scene.cameras[0].film(UVec2::splat(64));
        let mut looked = PointLanes::new();
        let mut surfaces = SurfaceLanes::default();
        let mut hits = 0;
        for round in 0..100 {
            let key = RandomKey::new(round);
            let keys = std::array::from_fn(|lane| key.mix(lane as u64));
            let places: [[f32; PACKET]; 2] = [0, 1]
                .map(|axis| std::array::from_fn(|lane| key.uniform2(lane as u32)[axis] * 64.0));
            let directions = film.directions(&places);
            let rays: [Ray; PACKET] = std::array::from_fn(|lane| {
                let direction = directions.map(|axis| axis[lane]);
                Ray::new(film.eye(), Vec3::from(direction))
            });
            let found = rays.each_ref().map(|ray| world.accel().closest(ray));
            scene.surfaces(&directions, &found, &mut surfaces);
            looked.look(scene, &surfaces, &keys);
            let mut set = PointLanes::new();
            for lane in 0..PACKET {
                if let Some(hit) = &found[lane] {
                    let surface = scene.surface(&rays[lane], hit);
                    set.set(lane, &surface, &Brdf::new(scene, &surface), keys[lane]);
                    hits += 1;
                }
            }
            let mut copied = PointLanes::new();
            for lane in (0..PACKET).filter(|&lane| found[lane].is_some()) {
                copied.copy(lane, &looked, lane);
                for axes in [&looked, &copied] {
                    assert_eq!(lane_of(axes, lane), lane_of(&set, lane));
                }
            }
            let all =
                |lanes: &PointLanes| (lanes.matt, lanes.smooth, lanes.is_glossy, lanes.origins);
            assert_eq!((all(&looked), all(&copied)), (all(&set), all(&set)));
        }
        assert!(hits > 1000, "{hits}");
    }

    /// All that a lane holds.
    fn lane_of(points: &PointLanes, lane: usize) -> (Vec<f32>, RandomKey) {
        let axes = [
            &points.position,
            &points.origin,
            &points.normal,
            &points.geometric_normal,
            &points.wo,
            &points.diffuse,
            &points.f0,
        ];
        let mut numbers: Vec<f32> = axes.iter().flat_map(|axes| points.at(axes, lane)).collect();
        let single = [&points.f90, &points.alpha2, &points.cos_o, &points.root_o];
        numbers.extend(single.map(|lanes| lanes[lane]));
        (numbers, points.keys[lane])
    }
}
