use glam::Vec3;
use lie_geom::Aabb;

use crate::{LightSet, OccluderLists};

/// A local illumination environment in the form that shading wants (LIE §4.2). A light of
/// the scene that is in none of the lists is fully occluded, or masked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LieCell {
    /// Where shadow rays must start for the rest to hold; `None` is everywhere.
    pub region: Option<Aabb>,
    /// Lights that every surface point in the cell sees whole.
    pub unoccluded: LightSet,
    /// Lights that some points do not see whole.
    pub partial: OccluderLists,
    /// Lights whose shadow rays go through the scene, since too little is known of them or
    /// too much is in the way.
    pub traced: LightSet,
}

impl LieCell {
    /// The form for shading of an LIE: lights with their occluders, in order of the lights'
    /// numbers, and lights that are traced.
    #[must_use]
    pub fn new<'a>(lights: impl Iterator<Item = (u32, &'a [u32])>, traced: LightSet) -> Self {
        let (mut unoccluded, mut partial) = (vec![], vec![]);
        for (light, occluders) in lights {
            if occluders.is_empty() {
                unoccluded.push(light);
            } else {
                partial.push((light, occluders.to_vec()));
            }
        }
        Self {
            region: None,
            unoccluded: unoccluded.into_iter().collect(),
            partial: OccluderLists::new(&partial),
            traced,
        }
    }

    /// Lights that are shaded without asking the scene.
    #[must_use]
    pub fn answered(&self) -> usize {
        self.unoccluded.len() + self.partial.len()
    }

    /// Memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.unoccluded.bytes() + self.partial.bytes() + self.traced.bytes()
    }
}

/// Finds the LIE of a point. What it answers must not change while a tile is rendered.
pub trait LieLookup: Sync {
    /// The LIE that holds for shadow rays from a point. Numbers of lights that the scene does
    /// not have are passed over.
    fn cell(&self, point: Vec3) -> &LieCell;

    /// Adds [`Self::cell`] of many points to `found`; neighbours should follow each other.
    fn cells<'a>(&'a self, points: &[Vec3], found: &mut Vec<&'a LieCell>) {
        found.extend(points.iter().map(|&point| self.cell(point)));
    }
}
