//! What all rays from one place have in common of `N` triangles, worked out for all of these
//! together.

use lie_geom::edge_planes;

use super::union;

/// Triangles as a light without extent sees them, or an eye.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct FanPlanes<const N: usize> {
    /// The planes through the apex and each edge, as of [`edge_planes`].
    planes: [[[f32; N]; 3]; 3],
}

impl<const N: usize> FanPlanes<N> {
    /// Those of some triangles, by their corners.
    #[inline(always)]
    pub(super) fn new(corners: &[[[f32; N]; 3]; 3], apex: [f32; 3]) -> Self {
        let mut planes = [[[0.0; N]; 3]; 3];
        for place in 0..N {
            let edges = edge_planes(all_at(corners, place), apex);
            for edge in 0..3 {
                for axis in 0..3 {
                    planes[edge][axis][place] = edges[edge][axis];
                }
            }
        }
        Self { planes }
    }

    /// One triangle's planes.
    #[inline(always)]
    pub(super) fn of(&self, place: usize) -> [[f32; 3]; 3] {
        all_at(&self.planes, place)
    }

    /// The triangles that some ray's line may pass inside: bit `i` for triangle `i`. `ways` are
    /// the ends of the interval that the rays' directions lie in, axis by axis.
    ///
    /// Rounding is monotonic, so what the same operations make of an interval's ends bounds
    /// what they make of a ray. Places that hold no triangle are near nothing.
    #[inline(always)]
    pub(super) fn near(&self, ways: [[f32; 3]; 2]) -> u32 {
        let mut near = [0u32; N];
        for place in 0..N {
            let a = interval(at(&self.planes[0], place), ways);
            let b = interval(at(&self.planes[1], place), ways);
            let c = interval(at(&self.planes[2], place), ways);
            let before = (a[0] > 0.0) | (b[0] > 0.0) | (c[0] > 0.0);
            let behind = (a[1] < 0.0) | (b[1] < 0.0) | (c[1] < 0.0);
            let is_zero = |[least, most]: [f32; 2]| (least == 0.0) & (most == 0.0);
            let is_flat = is_zero(a) & is_zero(b) & is_zero(c);
            let misses = (before & behind) | is_flat;
            near[place] = if misses { 0 } else { 1 << place };
        }
        union(&near)
    }
}

/// The least and the most that a scalar product may be.
#[inline(always)]
fn interval(plane: [f32; 3], ways: [[f32; 3]; 2]) -> [f32; 2] {
    let x = ends(plane[0] * ways[0][0], plane[0] * ways[1][0]);
    let y = ends(plane[1] * ways[0][1], plane[1] * ways[1][1]);
    let z = ends(plane[2] * ways[0][2], plane[2] * ways[1][2]);
    [x[0] + y[0] + z[0], x[1] + y[1] + z[1]]
}

#[inline(always)]
fn ends(a: f32, b: f32) -> [f32; 2] {
    [if a < b { a } else { b }, if a < b { b } else { a }]
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
