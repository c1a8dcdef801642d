//! Lists of occluders, and packets that are made without looking at each ray.

use glam::Vec3;
use lie_geom::{Aabb, Ray};
use lie_scene::Geometry;

use super::{odd_rays, odd_scenes, rays::exact_ends};
use crate::{
    AccelKind, BlockPart, FanOccluders, OccluderBlocks, PACKET, RayPacket,
    vector_unit::on_each_unit,
};

/// All triangles of a scene as blocks, and the list that names them all.
fn whole(geometry: &Geometry) -> (OccluderBlocks, Vec<BlockPart>) {
    let indices: Vec<u32> = (0..geometry.len() as u32).collect();
    let mut blocks = OccluderBlocks::default();
    blocks.fill(&indices, geometry.shapes());
    let part = |(block, chunk): (u32, &[u32])| BlockPart {
        block,
        places: ((1u32 << chunk.len()) - 1) as u16,
    };
    (
        blocks,
        (0..).zip(indices.chunks(PACKET)).map(part).collect(),
    )
}

/// Which rays some triangle blocks, one after the other.
fn expected(geometry: &Geometry, rays: &[Ray]) -> u32 {
    let is_blocked = |ray: &Ray| {
        let mut shapes = geometry.shapes().iter();
        ray.is_defined() && shapes.any(|shape| shape.intersect(ray).is_some())
    };
    (0..rays.len()).fold(0, |mask, lane| {
        mask | u32::from(is_blocked(&rays[lane])) << lane
    })
}

/// Coordinates by axis, as packets want them; left over are zeros.
fn by_axis(points: &[Vec3]) -> [[f32; PACKET]; 3] {
    let mut axes = [[0.0; PACKET]; 3];
    for (lane, point) in points.iter().enumerate() {
        for axis in 0..3 {
            axes[axis][lane] = point[axis];
        }
    }
    axes
}

#[test]
fn lists_block_what_each_triangle_says() {
    for (name, geometry) in odd_scenes() {
        let (blocks, parts) = whole(&geometry);
        let mut rays = odd_rays(&geometry);
        rays.extend(exact_ends(&geometry));
        on_each_unit(|| {
            for packet in rays.chunks(PACKET) {
                let together = RayPacket::new(packet);
                let blocked = together.blocked_by_parts(&blocks, &parts, None);
                assert_eq!(blocked, expected(&geometry, packet), "{name}: {packet:?}");
                let one_by_one = geometry.shapes().iter();
                let one_by_one =
                    one_by_one.fold(0, |mask, shape| mask | together.blocked_by(shape));
                assert_eq!(one_by_one, blocked, "{name}: {packet:?}");
            }
        });
    }
}

/// Segments between two places, whose packets know nothing of what is defined.
#[test]
fn segments_and_fans_with_odd_ends_block_what_each_triangle_says() {
    for (name, geometry) in odd_scenes() {
        let accel = AccelKind::Bvh.build(&geometry, None);
        let (blocks, parts) = whole(&geometry);
        let rays = odd_rays(&geometry);
        on_each_unit(|| {
            for odd in rays.chunks(PACKET - 1) {
                let starts: Vec<Vec3> = odd.iter().map(|ray| ray.origin).collect();
                let ends: Vec<Vec3> = odd.iter().map(|ray| ray.at(1.5)).collect();
                let lanes = (1 << odd.len()) - 1;
                let pairs = starts.iter().zip(&ends);
                let segments: Vec<Ray> = pairs.map(|(&a, &b)| Ray::segment(a, b)).collect();
                let wanted = expected(&geometry, &segments);
                let packet = RayPacket::segments(&by_axis(&starts), &by_axis(&ends), lanes);
                let found = packet.blocked_by_parts(&blocks, &parts, None);
                assert_eq!(found, wanted, "{name}: {segments:?}");
                assert_eq!(
                    accel.blocked_packet(&packet),
                    wanted,
                    "{name}: {segments:?}"
                );
                check_fan(
                    name,
                    &geometry,
                    &*accel,
                    (&blocks, &parts),
                    ends[0],
                    &starts,
                );
            }
        });
    }
}

/// Coordinates up to which fans are asked for, in metres: what all rays of one have in common is
/// bounded by products of three, which must not overflow for one of them.
const FAR: f32 = 1.0e12;

/// A fan from one place, odd or not, to all others of a packet that are not too far.
fn check_fan(
    name: &str,
    geometry: &Geometry,
    accel: &dyn crate::Accel,
    (blocks, parts): (&OccluderBlocks, &[BlockPart]),
    apex: Vec3,
    points: &[Vec3],
) {
    let near = points.iter().copied();
    let near: Vec<Vec3> = near
        .filter(|point| !point.is_finite() || point.abs().max_element() <= FAR)
        .collect();
    let points = &near[..];
    let to = |&point: &Vec3| Ray::segment_from(apex, point);
    let fan: Vec<Ray> = points.iter().map(to).collect();
    let wanted = expected(geometry, &fan);
    let lanes = (1 << points.len()) - 1;
    let packet = RayPacket::fan(apex.to_array(), &by_axis(points), lanes);
    assert_eq!(accel.blocked_packet(&packet), wanted, "{name}: {fan:?}");
    let mut seen = FanOccluders::default();
    seen.look_from(apex.to_array(), blocks, parts);
    // The box that they must end in is asked for of those that are rays.
    let defined = points.iter().filter(|&point| to(point).is_defined());
    let bounds = Aabb::around(defined.copied());
    let found = packet.blocked_by_fan(&seen, Some(bounds), None);
    assert_eq!(found, wanted, "{name}: {fan:?}");
}
