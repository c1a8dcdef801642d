use glam::Vec3;
use lie_accel::Occluders;

/// A local illumination environment in the form that shading wants (LIE §4.2).
#[derive(Clone, Debug, Default)]
pub struct LieCell {
    /// Whether it may be relied on; if not, every shadow ray goes through the scene.
    pub trusted: bool,
    /// Lights that every surface point in the cell sees whole, by number.
    pub unoccluded: Vec<u32>,
    /// Lights that some points see in part.
    pub partial: Vec<LieLight>,
}

/// A partially occluded light.
#[derive(Clone, Debug, Default)]
pub struct LieLight {
    /// Number of the light in the scene.
    pub light: u32,
    /// What may be in the way.
    pub occluders: Occluders,
}

impl LieCell {
    /// Memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let occluders: usize = self
            .partial
            .iter()
            .map(|entry| entry.occluders.bytes())
            .sum();
        size_of::<Self>()
            + size_of_val(&self.unoccluded[..])
            + size_of_val(&self.partial[..])
            + occluders
    }
}

/// Finds the LIE of a point. What it answers must not change while a tile is rendered.
pub trait LieLookup: Sync {
    /// The LIE of the smallest cell around a point.
    fn cell(&self, point: Vec3) -> &LieCell;
}

/// Knows nothing: every shadow ray goes through the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLies;

impl LieLookup for NoLies {
    fn cell(&self, _point: Vec3) -> &LieCell {
        static UNKNOWN: LieCell = LieCell {
            trusted: false,
            unoccluded: vec![],
            partial: vec![],
        };
        &UNKNOWN
    }
}
