//! Adaptive shadow testing (G. Ward 1994, *Adaptive shadow testing for ray tracing*), the
//! paper's comparator (LIE §2, §6).

use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

use glam::Vec3;
use lie_accel::{PACKET, RayPacket};
use lie_geom::Ray;

use crate::{LightPoints, LightRay, World};

/// Points that are tested together, so that rays to one light share packets.
const TOGETHER: usize = 16;

/// Adds the light of all lights at some points to their pixels' sums, and returns how many
/// shadow rays that took; `None` if `cancelled` became true on the way.
///
/// At each point the lights are tested from the one that would give most, were nothing in
/// the way, to the one that would give least, until what the rest would give is less than
/// `threshold` times what the tested ones were found to give. The rest is estimated: what
/// it would give, times the share of this point's rays that were clear. (Ward keeps the
/// share for each light over the whole picture; a pixel would then depend on those before
/// it.) A point's luminance is so off by less than `threshold` of itself, and with 0 it is
/// the standard ray tracer's, bit for bit.
pub(crate) fn shade<'p>(
    world: &World,
    threshold: f32,
    points: impl Iterator<Item = (usize, LightPoints<'p>)>,
    sums: &mut [Vec3],
    cancelled: &AtomicBool,
) -> Option<u64> {
    let mut testing = Testing {
        world,
        threshold,
        rays: vec![],
        points: vec![],
        traced: 0,
    };
    let mut points = points.peekable();
    while points.peek().is_some() {
        if cancelled.load(Ordering::Relaxed) {
            return None;
        }
        testing.rays.clear();
        testing.points.clear();
        for (pixel, light_points) in points.by_ref().take(TOGETHER) {
            testing.gather(pixel, &light_points);
        }
        while testing.round() {}
        testing.add(sums);
    }
    Some(testing.traced)
}

/// Some points whose lights are being tested.
struct Testing<'a> {
    world: &'a World,
    threshold: f32,
    /// The points' rays one after the other, each in the order in which the standard ray
    /// tracer adds them: the lights' own samples, then those that follow the lobe.
    rays: Vec<(LightRay, Fate)>,
    points: Vec<Point>,
    traced: u64,
}

#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Untested,
    Clear,
    Blocked,
}

/// A surface point.
struct Point {
    pixel: usize,
    rays: Range<usize>,
    /// The lights that could light it, the one that would give most first.
    lights: Vec<Candidate>,
    /// How many of them have been tested.
    tested: usize,
    /// Luminance that the tested ones give.
    seen: f32,
    clear_rays: u32,
    tested_rays: u32,
}

/// A light that could light a point.
struct Candidate {
    /// Its number.
    light: u32,
    /// Luminance that it would give if nothing were in the way.
    potential: f32,
    /// What this light and those after it would give.
    rest: f32,
    /// Its own samples, and those that follow the lobe.
    rays: [Range<usize>; 2],
}

impl Testing<'_> {
    /// Adds a point with all its rays.
    fn gather(&mut self, pixel: usize, light_points: &LightPoints<'_>) {
        let first = self.rays.len();
        let rays = &mut self.rays;
        for light in 0..self.world.scene().lights.len() as u32 {
            let push = |ray| rays.push((ray, Fate::Untested));
            self.world.for_each_light_ray(light, light_points, push);
        }
        let lobe = rays.len();
        let mut directions = vec![];
        light_points.lobe_directions(&mut directions);
        let push = |ray| rays.push((ray, Fate::Untested));
        self.world
            .for_each_lobe_ray(light_points, &directions, push);

        let mut lights = by_light(&rays[..lobe], first);
        for found in by_light(rays, lobe) {
            let place = lights.binary_search_by_key(&found.light, |known| known.light);
            match place {
                Ok(index) => {
                    lights[index].potential += found.potential;
                    lights[index].rays[1] = found.rays[0].clone();
                }
                Err(index) => lights.insert(index, found),
            }
        }
        // Stable: of equal lights the one with the lower number comes first.
        lights.sort_by(|a, b| b.potential.total_cmp(&a.potential));
        let mut rest = 0.0;
        for candidate in lights.iter_mut().rev() {
            rest += candidate.potential;
            candidate.rest = rest;
        }
        self.points.push(Point {
            pixel,
            rays: first..rays.len(),
            lights,
            tested: 0,
            seen: 0.0,
            clear_rays: 0,
            tested_rays: 0,
        });
    }

    /// Tests the next light of each point that is not done. Says whether there was any.
    fn round(&mut self) -> bool {
        let mut queue = vec![];
        for point in &self.points {
            if let Some(candidate) = point.next(self.threshold) {
                queue.extend(candidate.rays.iter().flat_map(Range::clone));
            }
        }
        for packet in queue.chunks(PACKET) {
            self.trace(packet);
        }
        self.traced += queue.len() as u64;
        for point in &mut self.points {
            if point.next(self.threshold).is_some() {
                point.conclude(&self.rays);
            }
        }
        !queue.is_empty()
    }

    fn trace(&mut self, indices: &[usize]) {
        let mut packet = [Ray::new(Vec3::ZERO, Vec3::X); PACKET];
        for (place, &index) in packet.iter_mut().zip(indices) {
            *place = self.rays[index].0.ray;
        }
        let packet = RayPacket::new(&packet[..indices.len()]);
        let blocked = self.world.accel().blocked_packet(&packet);
        for (lane, &index) in indices.iter().enumerate() {
            self.rays[index].1 = match blocked >> lane & 1 {
                0 => Fate::Clear,
                _ => Fate::Blocked,
            };
        }
    }

    /// Adds what was found, and an estimate for the rest, to the pixels.
    fn add(&self, sums: &mut [Vec3]) {
        for point in &self.points {
            let share = point.clear_rays as f32 / point.tested_rays.max(1) as f32;
            for (ray, fate) in &self.rays[point.rays.clone()] {
                sums[point.pixel] += match fate {
                    Fate::Clear => ray.radiance,
                    Fate::Blocked => continue,
                    Fate::Untested => share * ray.radiance,
                };
            }
        }
    }
}

impl Point {
    /// The light to be tested next; `None` if the rest gives too little to matter.
    fn next(&self, threshold: f32) -> Option<&Candidate> {
        let next = self.lights.get(self.tested)?;
        // Not `<=`: with a threshold of 0 every light is tested.
        let is_little = next.rest < threshold * self.seen;
        (!is_little).then_some(next)
    }

    /// Takes in what became of the next light's rays.
    fn conclude(&mut self, rays: &[(LightRay, Fate)]) {
        let ranges = self.lights[self.tested].rays.clone();
        for (ray, fate) in ranges.into_iter().flat_map(|range| &rays[range]) {
            self.tested_rays += 1;
            if *fate == Fate::Clear {
                self.clear_rays += 1;
                self.seen += ray.weight();
            }
        }
        self.tested += 1;
    }
}

/// The lights that the rays from index `first` on go to, in the rays' order; the rays to one
/// light follow each other.
fn by_light(rays: &[(LightRay, Fate)], first: usize) -> Vec<Candidate> {
    let mut start = first;
    let groups = rays[first..].chunk_by(|(a, _), (b, _)| a.light == b.light);
    groups
        .map(|group| {
            let range = start..start + group.len();
            start = range.end;
            Candidate {
                light: group[0].0.light,
                potential: group.iter().map(|(ray, _)| ray.weight()).sum(),
                rest: 0.0,
                rays: [range, 0..0],
            }
        })
        .collect()
}
