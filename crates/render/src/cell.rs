use glam::Vec3;
use lie_accel::Occluders;

/// A local illumination environment in the form that shading wants (LIE §4.2). A light of
/// the scene that is in none of the lists is fully occluded, or masked.
#[derive(Clone, Debug, Default)]
pub struct LieCell {
    /// Lights that every surface point in the cell sees whole, by number.
    pub unoccluded: Vec<u32>,
    /// Lights that some points see in part.
    pub partial: Vec<LieLight>,
    /// Lights whose shadow rays go through the scene, since too little is known of them or
    /// too much is in the way.
    pub traced: Vec<u32>,
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
            + size_of_val(&self.traced[..])
            + occluders
    }
}

/// Finds the LIE of a point. What it answers must not change while a tile is rendered.
pub trait LieLookup: Sync {
    /// The LIE of the smallest cell around a point. Numbers of lights that the scene does
    /// not have are passed over.
    fn cell(&self, point: Vec3) -> &LieCell;
}
