use lie_geom::Aabb;
use lie_scene::AreaLight;

use crate::{closed_form::Outlines, delta_lanes::DeltaLight};

/// A light in the form that shading wants.
pub(crate) enum LightForm<'a> {
    /// A point or a spot.
    Delta(&'a DeltaLight),
    /// An area light.
    Area(AreaForm<'a>),
    /// Anything else, or no light at all.
    Other,
}

/// An area light, with its outlines if it is integrated in closed form.
#[derive(Clone, Copy)]
pub(crate) struct AreaForm<'a> {
    pub(crate) light: &'a AreaLight,
    pub(crate) outlines: Option<&'a Outlines>,
    /// Where shadow rays to it end.
    pub(crate) ends: Aabb,
}
