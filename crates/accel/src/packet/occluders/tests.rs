use glam::Vec3;
use lie_geom::{RandomKey, Ray};

use super::*;
use crate::{
    bvh::tests::{Half, soup},
    packet::vector::on_each_unit,
};

fn vector(key: RandomKey, n: u32) -> Vec3 {
    let xy = key.uniform2(2 * n);
    Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 2.0 - Vec3::ONE
}

/// A list of about every third triangle.
fn list(key: RandomKey, blocks: u32) -> Vec<BlockPart> {
    let parts = (0..blocks).map(|block| BlockPart {
        block,
        places: (0..16).fold(0, |places, place| {
            places | u16::from(key.uniform(16 * block + place) < 0.3) << place
        }),
    });
    parts.collect()
}

/// What the list blocks, triangle by triangle and ray by ray.
fn expected(
    triangles: &[Triangle],
    parts: &[BlockPart],
    rays: &[Ray],
    cutout: Option<&dyn Cutout>,
) -> u32 {
    let blocks = |ray: &Ray, index: usize| {
        let Some(hit) = triangles.get(index).and_then(|shape| shape.intersect(ray)) else {
            return false;
        };
        let index = index as u32;
        cutout.is_none_or(|cutout| !cutout.has_holes(index) || cutout.is_solid(index, hit.u, hit.v))
    };
    let is_blocked = |ray: &Ray| {
        parts.iter().any(|part| {
            let places = (0..PACKET).filter(|place| part.places >> place & 1 == 1);
            places
                .into_iter()
                .any(|place| blocks(ray, PACKET * part.block as usize + place))
        })
    };
    (0..rays.len()).fold(0, |mask, ray| {
        mask | u32::from(is_blocked(&rays[ray])) << ray
    })
}

#[test]
fn lists_block_what_their_triangles_block() {
    on_each_unit(check_lists);
}

fn check_lists() {
    let geometry = soup(300, 5);
    let shapes = geometry.shapes();
    let mut blocks = OccluderBlocks::default();
    let indices: Vec<u32> = (0..300).collect();
    blocks.fill(&indices, shapes);
    assert_eq!((blocks.len(), blocks.is_empty()), (300, false));
    let (mut blocked, mut open) = (0, 0);
    for seed in 0..400 {
        let key = RandomKey::new(seed);
        let parts = list(key.mix(1), 19);
        let apex = 6.0 * vector(key, 0);
        let center = 6.0 * vector(key, 1);
        // Close together, as a cell's points are, or far apart.
        let spread = if seed % 2 == 0 { 0.1 } else { 4.0 };
        let count = 1 + seed as usize % PACKET;
        let points: Vec<Vec3> = (0..count as u32)
            .map(|point| center + spread * vector(key, 10 + point))
            .collect();
        let mut ends = [[0.0; PACKET]; 3];
        for (lane, point) in points.iter().enumerate() {
            for axis in 0..3 {
                ends[axis][lane] = point[axis];
            }
        }
        let rays: Vec<Ray> = points
            .iter()
            .map(|&point| Ray::segment_from(apex, point))
            .collect();
        let cutout: Option<&dyn Cutout> = if seed % 3 == 0 { Some(&Half) } else { None };
        let expected = expected(shapes, &parts, &rays, cutout);
        let packet = RayPacket::fan(apex.to_array(), &ends, (1 << count) - 1);
        let mut seen = FanOccluders::default();
        seen.look_from(apex.to_array(), &blocks, &parts);
        let bounds = Aabb::around(points);
        assert_eq!(
            packet.blocked_by_fan(&seen, Some(bounds), cutout),
            expected,
            "seed {seed}"
        );
        assert_eq!(packet.blocked_by_parts(&blocks, &parts, cutout), expected);
        blocked += expected.count_ones();
        open += count as u32 - expected.count_ones();
    }
    assert!(blocked > 200 && open > 200, "{blocked} blocked, {open} not");
}

#[test]
fn a_list_that_may_not_hide_a_box_blocks_nothing_on_the_way_there() {
    on_each_unit(check_clear);
}

fn check_clear() {
    let geometry = soup(300, 5);
    let shapes = geometry.shapes();
    let mut blocks = OccluderBlocks::default();
    let indices: Vec<u32> = (0..300).collect();
    blocks.fill(&indices, shapes);
    let mut seen = FanOccluders::default();
    let (mut clear, mut hidden, mut idle) = (0, 0, 0);
    for seed in 0..400 {
        let key = RandomKey::new(seed);
        let mut parts = list(key.mix(1), 19);
        parts.truncate(1 + seed as usize % 6);
        let (from, to) = (6.0 * vector(key, 0), 6.0 * vector(key, 1));
        let extent = if seed % 2 == 0 { 0.05 } else { 1.0 };
        let (mut origins, mut targets) = ([[0.0; PACKET]; 3], [[0.0; PACKET]; 3]);
        // Flat, as a light is, and not.
        let flat = if seed % 3 == 0 {
            Vec3::new(1.0, 0.0, 1.0)
        } else {
            Vec3::ONE
        };
        let corner = |n: u32| to + extent * flat * vector(key, n);
        let ends = Aabb::around([corner(100), corner(101), corner(102)]);
        let mut within = vec![];
        for lane in 0..PACKET {
            let origin = from + 0.2 * vector(key, 10 + lane as u32);
            let place = 0.5 * (vector(key, 50 + lane as u32) + Vec3::ONE);
            within.push((ends.min + place * (ends.max - ends.min)).clamp(ends.min, ends.max));
            for axis in 0..3 {
                origins[axis][lane] = origin[axis];
            }
        }
        let asked = if seed % 5 == 0 { 0x0f3f } else { 0xffff };
        let doubt = blocks.may_hide(&parts, ends, &origins, asked);
        assert_eq!(doubt & !asked, 0);
        for turn in 0..PACKET {
            for lane in 0..PACKET {
                for axis in 0..3 {
                    targets[axis][lane] = within[(lane + turn) % PACKET][axis];
                }
            }
            let packet = RayPacket::segments(&origins, &targets, asked);
            let blocked = packet.blocked_by_parts(&blocks, &parts, None);
            assert_eq!(blocked & !doubt, 0, "seed {seed}");
            hidden += blocked.count_ones();
            // The other way round: all targets from one origin.
            let apex = [0, 1, 2].map(|axis| origins[axis][turn]);
            let spread = RayPacket::spread(apex, &targets, asked);
            let expected = spread.blocked_by_parts(&blocks, &parts, None);
            for is_narrowed in [false, true] {
                if is_narrowed {
                    seen.look_to(apex, ends, &blocks, &parts);
                } else {
                    seen.look_from(apex, &blocks, &parts);
                }
                for ends in [None, Some(ends)] {
                    assert_eq!(spread.blocked_by_fan(&seen, ends, None), expected);
                }
            }
            idle += (doubt & !blocked).count_ones();
        }
        clear += 16 * (asked & !doubt).count_ones();
    }
    assert!(
        clear > 20_000 && hidden > 2000,
        "{clear} clear, {hidden} hidden, {idle} idle"
    );
}

#[test]
fn parts_that_name_no_block_block_nothing() {
    let mut blocks = OccluderBlocks::default();
    blocks.fill(&[], &[]);
    let parts = [BlockPart {
        block: 7,
        places: u16::MAX,
    }];
    let ends = [[1.0; PACKET]; 3];
    let packet = RayPacket::fan([0.0; 3], &ends, 0xffff);
    let mut seen = FanOccluders::default();
    seen.look_from([0.0; 3], &blocks, &parts);
    let bounds = Aabb::around([Vec3::ONE]);
    assert_eq!(packet.blocked_by_fan(&seen, Some(bounds), None), 0);
    assert_eq!(packet.blocked_by_parts(&blocks, &parts, None), 0);
}
