use lie_geom::Ray;
use lie_scene::Geometry;
use multiversion::multiversion;

use crate::{
    Cutout,
    block::{BLOCK, TriangleBlock},
};

/// A short list of triangles that a ray is tested against instead of the whole scene: the
/// occluders of one light in one cell (LIE §4).
#[derive(Clone, Debug, Default)]
pub struct Occluders {
    blocks: Vec<TriangleBlock>,
    len: usize,
}

impl Occluders {
    /// Gathers triangles of the scene, in this order. Indices past the end are an error of
    /// the caller and are left out.
    #[must_use]
    pub fn gather(geometry: &Geometry, cutout: Option<&dyn Cutout>, triangles: &[u32]) -> Self {
        let known: Vec<_> = triangles
            .iter()
            .filter(|&&id| (id as usize) < geometry.len())
            .map(|&id| {
                let holes = cutout.is_some_and(|cutout| cutout.has_holes(id));
                (id, *geometry.triangle(id), holes)
            })
            .collect();
        Self {
            blocks: known.chunks(BLOCK).map(TriangleBlock::new).collect(),
            len: known.len(),
        }
    }

    /// The first block's first triangle in the ray's interval.
    #[must_use]
    pub fn blocker(&self, ray: &Ray, cutout: Option<&dyn Cutout>) -> Option<u32> {
        if self.blocks.is_empty() {
            None
        } else {
            blocker_kernel(&self.blocks, ray, cutout)
        }
    }

    /// Whether any of them is in the ray's interval.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, cutout: Option<&dyn Cutout>) -> bool {
        self.blocker(ray, cutout).is_some()
    }

    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Heap memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn blocker_kernel(blocks: &[TriangleBlock], ray: &Ray, cutout: Option<&dyn Cutout>) -> Option<u32> {
    blocks
        .iter()
        .find_map(|block| block.blocker(ray, cutout).map(|lane| block.id(lane)))
}
