use lie_geom::{Aabb, Ray};

/// Children per node.
pub(crate) const WIDTH: usize = 8;

/// Where a child of a node leads: another node, a run of triangle blocks, or nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    pub(crate) const NONE: Self = Self(u32::MAX);

    pub(crate) fn node(index: usize) -> Self {
        assert!(index < Self::LEAF as usize, "too many nodes");
        Self(index as u32)
    }

    /// One block of triangles.
    pub(crate) fn leaf(block: usize) -> Self {
        assert!(block < (Self::LEAF - 1) as usize, "too many blocks");
        Self(block as u32 | Self::LEAF)
    }

    /// The block if this is a leaf, else the node.
    #[inline(always)]
    pub(crate) fn target(self) -> Target {
        if self.0 & Self::LEAF == 0 {
            Target::Node(self.0 as usize)
        } else {
            Target::Block((self.0 & !Self::LEAF) as usize)
        }
    }
}

pub(crate) enum Target {
    Node(usize),
    Block(usize),
}

/// Eight boxes and where they lead. Unused children hold boxes that nothing enters.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// `planes[2 · axis]` holds the minima, `planes[2 · axis + 1]` the maxima.
    pub(crate) planes: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
}

impl Node {
    pub(crate) fn new(children: &[(Aabb, Child)]) -> Self {
        assert!(children.len() <= WIDTH, "a node has {WIDTH} children");
        let mut node = Self {
            planes: [[f32::INFINITY; WIDTH]; 6],
            children: [Child::NONE; WIDTH],
        };
        for axis in 0..3 {
            node.planes[2 * axis + 1] = [f32::NEG_INFINITY; WIDTH];
        }
        for (lane, (bounds, child)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.planes[2 * axis][lane] = bounds.min[axis];
                node.planes[2 * axis + 1][lane] = bounds.max[axis];
            }
            node.children[lane] = *child;
        }
        node
    }

    /// Where a ray enters each child's box, or infinity.
    #[inline(always)]
    pub(crate) fn entries(&self, ray: &SlabRay, t_max: f32) -> [f32; WIDTH] {
        let near = [
            &self.planes[ray.near[0]],
            &self.planes[ray.near[1]],
            &self.planes[ray.near[2]],
        ];
        let far = [
            &self.planes[ray.near[0] ^ 1],
            &self.planes[ray.near[1] ^ 1],
            &self.planes[ray.near[2] ^ 1],
        ];
        let mut entries = [0.0; WIDTH];
        for lane in 0..WIDTH {
            let mut enter = ray.t_min;
            let mut leave = t_max;
            for axis in 0..3 {
                let t0 = (near[axis][lane] - ray.origin[axis]) * ray.inverse[axis];
                let t1 = (far[axis][lane] - ray.origin[axis]) * ray.inverse[axis] * WIDER;
                enter = if t0 > enter { t0 } else { enter };
                leave = if t1 < leave { t1 } else { leave };
            }
            entries[lane] = if enter <= leave { enter } else { f32::INFINITY };
        }
        entries
    }
}

/// 1 + 2 γ₄: makes the slab test conservative under rounding (Ize 2013, *Robust BVH Ray
/// Traversal*, which has γ₃), where this is multiplied with the inverse direction first as well.
pub(crate) const WIDER: f32 = 1.0 + 8.0 * f32::EPSILON / 2.0 * 1.01;

/// What the slab test needs of a ray.
pub(crate) struct SlabRay {
    origin: [f32; 3],
    inverse: [f32; 3],
    t_min: f32,
    /// Index of the plane that the ray meets first, by axis.
    near: [usize; 3],
}

impl SlabRay {
    pub(crate) fn new(ray: &Ray) -> Self {
        let inverse = ray.direction.to_array().map(inverse);
        Self {
            origin: ray.origin.to_array(),
            inverse,
            t_min: ray.t_min,
            near: [0, 1, 2].map(|axis| 2 * axis + usize::from(inverse[axis] < 0.0)),
        }
    }
}

/// What stands for an infinite inverse of a direction.
pub(crate) const LARGEST_INVERSE: f32 = 1.0e30;

/// One over a direction, with infinities made large instead: zero times the result is zero.
///
/// Comparisons instead of `clamp`: the same two instructions whatever the input.
#[allow(clippy::manual_clamp)]
#[inline(always)]
pub(crate) fn inverse(direction: f32) -> f32 {
    let inverse = 1.0 / direction;
    if inverse > LARGEST_INVERSE {
        LARGEST_INVERSE
    } else if inverse < -LARGEST_INVERSE {
        -LARGEST_INVERSE
    } else {
        inverse
    }
}
