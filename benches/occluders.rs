//! Packets against lists of occluders, by vector unit, and against the same triangles one by one.
//!
//! `cargo bench --bench occluders` prints tests per second: rays times triangles of the list, as
//! the renderer counts them. A ray that is blocked soon skips most of its tests, and a
//! triangle that no ray of a fan comes near is one test for all: that is what lists are for.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

mod fixture;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixture::{Seen, Shadows, brief, count, gallery, is_area, is_point_or_spot};
use lie_accel::{Accel, BlockPart, FanOccluders, OccluderBlocks, PACKET, RayPacket, VectorUnit};
use lie_geom::{Aabb, Ray, Triangle};
use lie_render::World;
use lie_scene::Light;

/// Triangles in a list. In the mosque a ray meets fifteen, in the mean.
const LENGTHS: [usize; 4] = [1, 8, 24, 96];

/// A list of occluders, whole.
struct List {
    triangles: Vec<Triangle>,
    blocks: OccluderBlocks,
    parts: Vec<BlockPart>,
}

impl List {
    fn new(world: &World, indices: &[u32]) -> Self {
        let shapes = indices.iter().filter_map(|&index| world.triangle(index));
        let triangles: Vec<Triangle> = shapes.copied().collect();
        let mut blocks = OccluderBlocks::default();
        blocks.fill(indices, &triangles);
        let part = |(block, chunk): (u32, &[u32])| BlockPart {
            block,
            places: ((1u32 << chunk.len()) - 1) as u16,
        };
        Self {
            triangles,
            blocks,
            parts: (0..).zip(indices.chunks(PACKET)).map(part).collect(),
        }
    }
}

/// Triangles that do come in between somewhere, as in cells' lists.
fn blockers(accel: &dyn Accel, shadows: &[Shadows]) -> Vec<u32> {
    let rays = shadows.iter().flat_map(Shadows::rays);
    let mut blockers: Vec<u32> = rays.filter_map(|ray| accel.blocker(&ray)).collect();
    blockers.sort_unstable();
    blockers.dedup();
    blockers
}

/// The light of a kind that shines on most of what is seen, and what such lights have in their way.
struct Case {
    shadows: Vec<Shadows>,
    lists: Vec<List>,
}

impl Case {
    fn new(seen: &Seen, of: fn(&Light) -> bool) -> Self {
        let lights = seen.world.scene().lights.iter().filter(|light| of(light));
        let names: Vec<&str> = lights.map(|light| light.name.as_str()).collect();
        let every = blockers(seen.world.accel(), &seen.shadows(of));
        let of_name = |name| seen.shadows(|light| of(light) && light.name == name);
        let most = names
            .into_iter()
            .map(of_name)
            .max_by_key(|shadows| count(shadows));
        let shadows = most.expect("the scene has lights of the kind");
        let list = |length: usize| {
            let stride = (every.len() / length).max(1);
            let indices: Vec<u32> = every.iter().copied().step_by(stride).take(length).collect();
            List::new(&seen.world, &indices)
        };
        Self {
            lists: LENGTHS.into_iter().map(list).collect(),
            shadows,
        }
    }

    fn tests(&self, list: &List) -> Throughput {
        Throughput::Elements(count(&self.shadows) * list.triangles.len() as u64)
    }

    /// The scalar twin: every ray against every triangle until one blocks it.
    fn one_by_one(&self, list: &List) -> usize {
        let is_blocked = |ray: &Ray| {
            let mut triangles = list.triangles.iter();
            triangles.any(|triangle| triangle.intersect(ray).is_some())
        };
        let rays = self.shadows.iter().flat_map(Shadows::rays);
        rays.filter(is_blocked).count()
    }
}

/// Lights without extent: what all rays share is worked out once for a list.
fn points(criterion: &mut Criterion) {
    let seen = Seen::new(gallery());
    let case = Case::new(&seen, is_point_or_spot);
    let apex = case.shadows[0].apex();
    let fan = |shadows: &Shadows| (shadows.fan(), Aabb::around(shadows.starts.iter().copied()));
    let fans: Vec<(RayPacket, Aabb)> = case.shadows.iter().map(fan).collect();
    let mut group = criterion.benchmark_group("lists of a point or spot");
    for list in &case.lists {
        let length = list.triangles.len();
        group.throughput(case.tests(list));
        for unit in VectorUnit::all() {
            group.bench_function(format!("{length} triangles, {}", unit.name()), |bencher| {
                let mut seen = FanOccluders::default();
                seen.look_from(apex.to_array(), &list.blocks, &list.parts);
                let test = |(packet, ends): &(RayPacket, Aabb)| {
                    packet.blocked_by_fan(&seen, Some(*ends), None).count_ones()
                };
                unit.run(|| bencher.iter(|| -> u32 { fans.iter().map(test).sum() }));
            });
        }
        group.bench_function(format!("{length} triangles, scalar twin"), |bencher| {
            bencher.iter(|| case.one_by_one(list));
        });
    }
    // What comes before: as many elements as triangles.
    for list in &case.lists {
        let length = list.triangles.len();
        group.throughput(Throughput::Elements(length as u64));
        for unit in VectorUnit::all() {
            let name = format!("{length} triangles, look from the light, {}", unit.name());
            group.bench_function(name, |bencher| {
                let mut seen = FanOccluders::default();
                let look = || seen.look_from(apex.to_array(), &list.blocks, &list.parts);
                unit.run(|| bencher.iter(look));
            });
        }
    }
    group.finish();
}

/// Area lights: rays start at surfaces and end anywhere on the light.
fn areas(criterion: &mut Criterion) {
    let seen = Seen::new(gallery());
    let case = Case::new(&seen, is_area);
    let packets: Vec<RayPacket> = case.shadows.iter().map(Shadows::segments).collect();
    let mut group = criterion.benchmark_group("lists of an area light");
    for list in &case.lists {
        let length = list.triangles.len();
        group.throughput(case.tests(list));
        for unit in VectorUnit::all() {
            group.bench_function(format!("{length} triangles, {}", unit.name()), |bencher| {
                let test = |packet: &RayPacket| {
                    let blocked = packet.blocked_by_parts(&list.blocks, &list.parts, None);
                    blocked.count_ones()
                };
                unit.run(|| bencher.iter(|| -> u32 { packets.iter().map(test).sum() }));
            });
        }
        group.bench_function(format!("{length} triangles, scalar twin"), |bencher| {
            bencher.iter(|| case.one_by_one(list));
        });
    }
    // Sixteen samples of one pixel, which looks at the list first; and which pixels must.
    let ends = Aabb::around(case.shadows.iter().flat_map(|group| group.targets.clone()));
    let spreads: Vec<([f32; 3], RayPacket)> = case
        .shadows
        .iter()
        .map(|group| (group.starts[0].to_array(), group.spread()))
        .collect();
    for list in &case.lists {
        let length = list.triangles.len();
        group.throughput(case.tests(list));
        for unit in VectorUnit::all() {
            let name = format!("{length} triangles, samples of one pixel, {}", unit.name());
            group.bench_function(name, |bencher| {
                let mut seen = FanOccluders::default();
                let mut test = |(apex, packet): &([f32; 3], RayPacket)| {
                    seen.look_to(*apex, ends, &list.blocks, &list.parts);
                    packet.blocked_by_fan(&seen, None, None).count_ones()
                };
                unit.run(|| bencher.iter(|| -> u32 { spreads.iter().map(&mut test).sum() }));
            });
            let name = format!("{length} triangles, what may be hidden, {}", unit.name());
            group.bench_function(name, |bencher| {
                let test = |shadows: &Shadows| {
                    let (blocks, parts) = (&list.blocks, &list.parts);
                    let origins = shadows.origins();
                    let doubt = blocks.may_hide(parts, ends, &origins, shadows.lanes());
                    doubt.count_ones()
                };
                unit.run(|| bencher.iter(|| -> u32 { case.shadows.iter().map(test).sum() }));
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = occluders;
    config = brief();
    targets = points, areas
}
criterion_main!(occluders);
