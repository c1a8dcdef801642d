use lie_geom::RandomKey;
use lie_scene::Surface;

use crate::{Brdf, LieCell};

/// A camera ray that met a surface, waiting for its light.
pub(crate) struct ShadingPoint<'a> {
    /// Index of its pixel in the square.
    pub(crate) pixel: usize,
    pub(crate) key: RandomKey,
    pub(crate) surface: Surface,
    pub(crate) brdf: Brdf,
    pub(crate) cell: Option<&'a LieCell>,
}
