use glam::Vec3;
use lie_accel::{PACKET, RayPacket};
use lie_geom::{RandomKey, Ray, sampling};
use lie_octree::{GROUP, LieTree, Observation, Observer, Proof, ShadowRay, Visibility};
use lie_render::{LightPoints, LightRay, World};

use super::{neighbours::Neighbours, point::Point, prove::Prover};

const _: () = assert!(GROUP == PACKET, "construction's groups of rays are packets");

/// What samples are taken with.
pub(super) struct Sampling<'a> {
    pub(super) world: &'a World,
    pub(super) neighbours: &'a Neighbours,
    pub(super) prover: Option<&'a Prover>,
    pub(super) tree: &'a LieTree,
    /// Luminance of a typical pixel.
    pub(super) typical: f32,
    /// Whether lights that proofs serve and could not settle are left for a later pass: a few
    /// samples would not be enough to rely on, and time is better spent on proofs elsewhere.
    pub(super) is_survey: bool,
}

impl Sampling<'_> {
    /// Samples what the camera sees in a square's pixels: LIE §4.1, but for all rays to a light
    /// that a frame would trace instead of one. Lights that are settled need no rays.
    pub(super) fn observe(&self, random: RandomKey, mut points: Vec<Point>) -> Vec<Observation> {
        let (world, tree) = (self.world, self.tree);
        points.sort_by_cached_key(|point| tree.key_at(point.surface.shadow_origin));
        let origins = points.iter().map(|point| point.surface.shadow_origin);
        let origins: Vec<Vec3> = origins.collect();
        let strata = sampling::strata(world.scene().settings.light_samples);
        let visibility = VisibilityOf {
            world,
            neighbours: self.neighbours,
            points: &points,
            strata,
        };
        let mut observer = Observer::new(tree, &origins, self.typical, random, &visibility);
        let serves = |light| self.prover.is_some_and(|prover| prover.serves(light));
        let passes_over = |light| self.is_survey && serves(light);
        observer.count_settled(passes_over);
        let mut rays = vec![];
        for light in 0..world.scene().lights.len() as u32 {
            if passes_over(light) || !observer.is_open(light) {
                continue;
            }
            rays.clear();
            for (index, point) in (0..).zip(&points) {
                match observer.proof(index, light) {
                    // Nobody has tried, since it does not reach the cell's points.
                    None if serves(light) => {}
                    None | Some(Proof::Open) => {
                        gather_rays(world, light, index, &point.light_points(strata), &mut rays);
                    }
                    Some(_) => {}
                }
            }
            if !rays.is_empty() {
                observer.light(light, &rays);
            }
        }
        observer.finish()
    }
}

/// The shadow rays from one point to one light that LIEs answer for.
fn gather_rays(
    world: &World,
    light: u32,
    point: u32,
    light_points: &LightPoints<'_>,
    rays: &mut Vec<ShadowRay>,
) {
    let mut exact = None;
    let mut beside = 0.0;
    let before = rays.len();
    let shadow_ray = |ray: &LightRay| ShadowRay {
        point,
        ray: ray.ray,
        weight: ray.weight(),
        beside: 0.0,
    };
    world.for_each_light_ray(light, light_points, |ray| {
        if ray.exact {
            beside += ray.weight();
            exact = Some(shadow_ray(&ray));
        } else {
            rays.push(shadow_ray(&ray));
        }
    });
    // Exact rays tell something only where there are no others: that the light is there.
    if rays.len() == before {
        rays.extend(exact);
    }
    for ray in &mut rays[before..] {
        ray.beside = beside;
    }
}

/// The scene, as it is seen from some points.
struct VisibilityOf<'a> {
    world: &'a World,
    neighbours: &'a Neighbours,
    points: &'a [Point],
    strata: (u32, u32),
}

impl Visibility for VisibilityOf<'_> {
    type Rays = (RayPacket, Vec<Ray>);

    fn gather(&self, rays: &[Ray]) -> Self::Rays {
        (RayPacket::new(rays), rays.to_vec())
    }

    fn blockers(&self, (packet, _): &Self::Rays) -> [Option<u32>; GROUP] {
        self.world.accel().blocker_packet(packet)
    }

    fn blocked_by(&self, triangle: u32, (packet, rays): &Self::Rays) -> u32 {
        self.world.blocked_by(triangle, packet, rays)
    }

    fn neighbours(&self, triangle: u32, found: &mut Vec<u32>) {
        found.extend(self.neighbours.of(&self.world.scene().geometry, triangle));
    }

    fn aim(&self, point: u32, triangle: u32, light: u32, random: RandomKey) -> Option<(Ray, Vec3)> {
        let point = &self.points[point as usize];
        let light_points = point.light_points(self.strata);
        let weights = sampling::square_to_triangle(random.uniform2(0));
        let triangle = self.world.triangle(triangle)?;
        let place = triangle.a
            + weights.x * (triangle.b - triangle.a)
            + weights.y * (triangle.c - triangle.a);
        let ray = self.world.light_ray_past(light, &light_points, place);
        ray.filter(|ray| !ray.exact)
            .map(|ray| (ray.ray, ray.surface_end()))
    }
}
