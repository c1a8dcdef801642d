use glam::Vec3;

use crate::World;

/// A local illumination environment in the form that shading wants (LIE §4.2). A light of
/// the scene that is in none of the lists is fully occluded, or masked.
#[derive(Clone, Debug, Default)]
pub struct LieCell {
    /// Lights that every surface point in the cell sees whole, by number.
    pub unoccluded: Vec<u32>,
    /// Lights that some points do not see whole.
    pub partial: Vec<LieLight>,
    /// Lights whose shadow rays go through the scene, since too little is known of them or
    /// too much is in the way, in rising order.
    pub traced: Vec<u32>,
}

/// A partially occluded light.
#[derive(Clone, Debug, Default)]
pub struct LieLight {
    /// Number of the light in the scene.
    pub light: u32,
    /// Triangles that may be in the way. Sixteen rays are tested against one at a time: its
    /// number is enough.
    pub occluders: Box<[u32]>,
}

impl LieCell {
    /// The form for shading of an LIE: lights with their occluders, and lights that are
    /// traced. Triangles that the scene does not have are left out.
    #[must_use]
    pub fn new<'a>(
        world: &World,
        lights: impl Iterator<Item = (u32, &'a [u32])>,
        traced: Vec<u32>,
    ) -> Self {
        let scene = world.scene();
        let mut cell = Self {
            traced,
            ..Self::default()
        };
        for (light, occluders) in lights {
            if occluders.is_empty() {
                cell.unoccluded.push(light);
                continue;
            }
            let exists = |triangle: &u32| (*triangle as usize) < scene.geometry.len();
            let occluders = occluders.iter().copied().filter(exists).collect();
            cell.partial.push(LieLight { light, occluders });
        }
        cell
    }

    /// Lights that are shaded without asking the scene.
    #[must_use]
    pub fn answered(&self) -> usize {
        self.unoccluded.len() + self.partial.len()
    }

    /// Memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let lists = self.partial.iter();
        size_of::<Self>()
            + size_of_val(&self.unoccluded[..])
            + size_of_val(&self.partial[..])
            + size_of_val(&self.traced[..])
            + lists
                .map(|entry| size_of_val(&entry.occluders[..]))
                .sum::<usize>()
    }
}

/// Finds the LIE of a point. What it answers must not change while a tile is rendered.
pub trait LieLookup: Sync {
    /// The LIE of the smallest cell around a point. Numbers of lights that the scene does
    /// not have are passed over.
    fn cell(&self, point: Vec3) -> &LieCell;

    /// [`Self::cell`] of many points; neighbours should follow each other.
    fn for_each_cell<'a>(
        &'a self,
        points: &mut dyn Iterator<Item = Vec3>,
        found: &mut dyn FnMut(&'a LieCell),
    ) {
        for point in points {
            found(self.cell(point));
        }
    }
}
