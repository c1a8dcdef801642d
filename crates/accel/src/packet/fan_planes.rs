//! What all rays from one place have in common of some triangles, worked out for all of these
//! together, eight or sixteen to a vector.

use fearless_simd::prelude::*;
use lie_geom::edge_planes;

use super::vector::{load_axes, splat_axes};

/// The planes through an apex and each edge of some triangles, as of [`edge_planes`]: edge by
/// edge, and axis by axis.
pub(super) type FanPlanes<V> = [[V; 3]; 3];

/// The planes of the triangles with these corners.
#[inline(always)]
pub(super) fn fan_planes<S: Simd, V: SimdFloat<S, Element = f32>>(
    simd: S,
    corners: &[[V::Array; 3]; 3],
    apex: [f32; 3],
) -> FanPlanes<V> {
    let corners: [[V; 3]; 3] = [
        load_axes(simd, &corners[0]),
        load_axes(simd, &corners[1]),
        load_axes(simd, &corners[2]),
    ];
    edge_planes(corners, splat_axes(simd, apex))
}

/// The triangles that some ray's line may pass inside: bit `i` for triangle `i`. `ways` are
/// the ends of the interval that the rays' directions lie in, axis by axis.
///
/// Rounding is monotonic, so what the same operations make of an interval's ends bounds
/// what they make of a ray. Places that hold no triangle are near nothing.
#[inline(always)]
pub(super) fn near<S: Simd, V: SimdFloat<S, Element = f32>>(
    planes: &FanPlanes<V>,
    ways: [[f32; 3]; 2],
) -> u32 {
    let [a, b, c] = [
        interval(planes[0], ways),
        interval(planes[1], ways),
        interval(planes[2], ways),
    ];
    let before = a[0].max(b[0]).max(c[0]).simd_gt(0.0);
    let behind = a[1].min(b[1]).min(c[1]).simd_lt(0.0);
    let lowest = a[0].min(b[0]).min(c[0]);
    let highest = a[1].max(b[1]).max(c[1]);
    let is_flat = lowest.simd_eq(0.0) & highest.simd_eq(0.0);
    (!((before & behind) | is_flat)).to_bitmask() as u32
}

/// The triangles whose plane some ray may cross on its way from 0 to 1, by the apex's offset from
/// it ([`lie_geom::plane_offset`]) and the interval of directions: bit `i` for triangle `i`.
#[inline(always)]
pub(super) fn between<S: Simd, V: SimdFloat<S, Element = f32>>(
    offset: V,
    normal: [V; 3],
    ways: [[f32; 3]; 2],
) -> u32 {
    let [least, most] = interval(normal, ways);
    // Less far along than the plane is: the ray ends before it. In doubt it crosses.
    let before = offset.simd_gt(0.0) & most.simd_le(offset);
    let behind = offset.simd_lt(0.0) & least.simd_ge(offset);
    (!(before | behind | offset.simd_eq(0.0))).to_bitmask() as u32
}

/// The least and the most that a scalar product may be.
#[inline(always)]
fn interval<S: Simd, V: SimdFloat<S, Element = f32>>(plane: [V; 3], ways: [[f32; 3]; 2]) -> [V; 2] {
    let x = ends(plane[0] * ways[0][0], plane[0] * ways[1][0]);
    let y = ends(plane[1] * ways[0][1], plane[1] * ways[1][1]);
    let z = ends(plane[2] * ways[0][2], plane[2] * ways[1][2]);
    [x[0] + y[0] + z[0], x[1] + y[1] + z[1]]
}

#[inline(always)]
fn ends<S: Simd, V: SimdFloat<S>>(a: V, b: V) -> [V; 2] {
    [a.min(b), a.max(b)]
}

/// One triangle's planes.
#[inline(always)]
pub(super) fn edges<S: Simd, V: SimdFloat<S, Element = f32>>(
    planes: &FanPlanes<V>,
    place: usize,
) -> [[f32; 3]; 3] {
    let at = |plane: &[V; 3]| [plane[0][place], plane[1][place], plane[2][place]];
    [at(&planes[0]), at(&planes[1]), at(&planes[2])]
}

/// One place of three coordinates.
#[inline(always)]
pub(super) fn at<const N: usize>(axes: &[[f32; N]; 3], place: usize) -> [f32; 3] {
    [axes[0][place], axes[1][place], axes[2][place]]
}

/// One place of three vectors.
#[inline(always)]
pub(super) fn all_at<const N: usize>(vectors: &[[[f32; N]; 3]; 3], place: usize) -> [[f32; 3]; 3] {
    [
        at(&vectors[0], place),
        at(&vectors[1], place),
        at(&vectors[2], place),
    ]
}
