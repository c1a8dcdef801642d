use lie_geom::{LaneHit, Ray, Triangle, intersect_lane};

use crate::Cutout;

/// Triangles per block.
pub(crate) const BLOCK: usize = 8;

/// Marks, in a block's ids, a triangle that may have holes.
const HOLES: u32 = 1 << 31;

/// The id of an unused lane.
const UNUSED: u32 = u32::MAX;

/// Up to eight triangles, one coordinate after the other, ready to be tested at once.
///
/// Unused lanes come last; they hold degenerate triangles, which nothing ever hits.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct TriangleBlock {
    pub(crate) corners: [[[f32; BLOCK]; 3]; 3],
    pub(crate) normal: [[f32; BLOCK]; 3],
    ids: [u32; BLOCK],
}

/// A block's hits by one ray.
pub(crate) struct BlockHits {
    pub(crate) t: [f32; BLOCK],
    weight_b: [f32; BLOCK],
    weight_c: [f32; BLOCK],
    sum: [f32; BLOCK],
}

impl TriangleBlock {
    /// A block from up to eight triangles, each with its index and whether it may have holes.
    pub(crate) fn new(triangles: &[(u32, Triangle, bool)]) -> Self {
        assert!(triangles.len() <= BLOCK, "a block holds {BLOCK} triangles");
        let mut block = Self {
            corners: [[[0.0; BLOCK]; 3]; 3],
            normal: [[0.0; BLOCK]; 3],
            ids: [UNUSED; BLOCK],
        };
        for (lane, (id, triangle, holes)) in triangles.iter().enumerate() {
            for axis in 0..3 {
                block.corners[0][axis][lane] = triangle.a[axis];
                block.corners[1][axis][lane] = triangle.b[axis];
                block.corners[2][axis][lane] = triangle.c[axis];
                block.normal[axis][lane] = triangle.normal[axis];
            }
            block.ids[lane] = id | if *holes { HOLES } else { 0 };
        }
        block
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.ids.iter().take_while(|&&id| id != UNUSED).count()
    }

    /// Index of the triangle in a used lane.
    #[inline(always)]
    pub(crate) fn id(&self, lane: usize) -> u32 {
        self.ids[lane] & !HOLES
    }

    /// One lane's triangle: corners and normal.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> ([[f32; 3]; 3], [f32; 3]) {
        let corner = |k: usize| {
            let corner = &self.corners[k];
            [corner[0][lane], corner[1][lane], corner[2][lane]]
        };
        let normal = [
            self.normal[0][lane],
            self.normal[1][lane],
            self.normal[2][lane],
        ];
        ([corner(0), corner(1), corner(2)], normal)
    }

    /// All lanes against one ray.
    #[inline(always)]
    pub(crate) fn intersect(&self, ray: &Ray, t_max: f32) -> BlockHits {
        let mut hits = BlockHits {
            t: [0.0; BLOCK],
            weight_b: [0.0; BLOCK],
            weight_c: [0.0; BLOCK],
            sum: [0.0; BLOCK],
        };
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        for lane in 0..BLOCK {
            let (corners, normal) = self.lane(lane);
            let hit = intersect_lane(corners, normal, origin, direction, ray.t_min, t_max);
            hits.t[lane] = hit.t;
            hits.weight_b[lane] = hit.weight_b;
            hits.weight_c[lane] = hit.weight_c;
            hits.sum[lane] = hit.sum;
        }
        hits
    }

    /// Whether a lane's triangle may have holes.
    #[inline(always)]
    pub(crate) fn has_holes(&self, lane: usize) -> bool {
        self.ids[lane] & HOLES != 0
    }

    /// Whether a hit on this lane is on solid matter.
    #[inline(always)]
    pub(crate) fn is_solid(&self, lane: usize, hit: LaneHit, cutout: Option<&dyn Cutout>) -> bool {
        if !self.has_holes(lane) {
            return true;
        }
        let weights = hit.hit();
        cutout.is_none_or(|cutout| cutout.is_solid(self.id(lane), weights.u, weights.v))
    }

    /// The first lane, if any, that blocks the ray.
    #[inline(always)]
    pub(crate) fn blocker(&self, ray: &Ray, cutout: Option<&dyn Cutout>) -> Option<usize> {
        let hits = self.intersect(ray, ray.t_max);
        let mut nearest = f32::INFINITY;
        for t in hits.t {
            nearest = if t < nearest { t } else { nearest };
        }
        if nearest == f32::INFINITY {
            return None;
        }
        (0..BLOCK).find(|&lane| {
            hits.t[lane] < f32::INFINITY && self.is_solid(lane, hits.lane(lane), cutout)
        })
    }
}

impl BlockHits {
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> LaneHit {
        LaneHit {
            t: self.t[lane],
            weight_b: self.weight_b[lane],
            weight_c: self.weight_c[lane],
            sum: self.sum[lane],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lie_geom::RandomKey;

    #[test]
    fn lanes_give_the_scalar_twins_bits() {
        let key = RandomKey::new(3);
        let point = |n: u32| {
            let xy = key.uniform2(2 * n);
            Vec3::new(xy.x, xy.y, key.uniform(2 * n + 1)) * 4.0 - Vec3::splat(2.0)
        };
        let mut hits = 0;
        for round in 0..2000 {
            let base = round * 40;
            let triangles: Vec<_> = (0..(round % 9))
                .map(|i| {
                    let corner = base + 3 * i;
                    (
                        i,
                        Triangle::new(point(corner), point(corner + 1), point(corner + 2)),
                        false,
                    )
                })
                .collect();
            let block = TriangleBlock::new(&triangles);
            assert_eq!(block.len(), triangles.len());
            let ray = Ray {
                t_max: 1.5,
                ..Ray::new(point(base + 30), point(base + 31))
            };
            let found = block.intersect(&ray, ray.t_max);
            for (lane, (_, triangle, _)) in triangles.iter().enumerate() {
                let twin = triangle.intersect(&ray);
                let lane_hit = (found.t[lane] < f32::INFINITY).then(|| found.lane(lane).hit());
                assert_eq!(lane_hit, twin);
                hits += usize::from(twin.is_some());
            }
            assert!(
                found.t[triangles.len()..]
                    .iter()
                    .all(|&t| t == f32::INFINITY)
            );
        }
        assert!(hits > 100, "the test must hit something: {hits}");
    }
}
