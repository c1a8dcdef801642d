use glam::Vec3;
use lie_accel::{PACKET, RayPacket};

use crate::{
    LieCell, LightPoints, LightRay, World,
    light_form::LightForm,
    occluder_lists::{LightList, OpenLists},
};

/// How the light of a cell is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightAnswer {
    /// Without a ray.
    Unoccluded,
    /// By rays against so many occluders.
    Listed(u64),
    /// By rays through the scene.
    Traced,
    /// It is left out.
    Hidden,
}

/// What becomes of a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RayAnswer {
    /// Its light is added, unasked or since no occluder of the list is in the way.
    Shown,
    /// Its light is not added.
    Withheld,
    /// The scene is asked.
    Traced,
}

/// What a cell answers, ray by ray: the same as [`crate::render_tile`] makes of it for sixteen
/// pixels at a time.
pub(crate) struct CellAnswers<'a> {
    world: &'a World,
    cell: &'a LieCell,
    lists: OpenLists,
}

impl<'a> CellAnswers<'a> {
    pub(crate) fn new(world: &'a World, cell: &'a LieCell) -> Self {
        let mut lists = OpenLists::default();
        lists.open(&cell.partial, world.scene().geometry.shapes());
        Self { world, cell, lists }
    }

    /// Whether it is this cell that answers.
    pub(crate) fn is_of(&self, cell: &LieCell) -> bool {
        std::ptr::eq(self.cell, cell)
    }

    /// Turns to another cell; nothing is done if it is the same one.
    pub(crate) fn turn_to(&mut self, cell: &'a LieCell) {
        if !std::ptr::eq(self.cell, cell) {
            let shapes = self.world.scene().geometry.shapes();
            self.lists.open(&cell.partial, shapes);
            self.cell = cell;
        }
    }

    fn list(&self, light: u32) -> Option<&LightList> {
        let lists = &self.lists.lights;
        let place = lists.binary_search_by_key(&light, |list| list.light);
        place.ok().map(|place| &lists[place])
    }

    /// The cell.
    pub(crate) fn cell(&self) -> &'a LieCell {
        self.cell
    }

    /// Whether all of an area light is clear of its list from a place: its rays are not asked.
    pub(crate) fn is_clear(&self, light: u32, origin: Vec3) -> bool {
        let origins = origin.to_array().map(|axis| [axis; PACKET]);
        match (self.world.light_form(light), self.list(light)) {
            (LightForm::Area(form), Some(list)) => {
                self.lists.may_hide(list, form, &origins, 1) == 0
            }
            _ => false,
        }
    }

    /// How a light is found.
    pub(crate) fn of(&self, light: u32) -> LightAnswer {
        if self.cell.unoccluded.contains(light) {
            LightAnswer::Unoccluded
        } else if let Some(list) = self.list(light) {
            LightAnswer::Listed(list.occluders)
        } else if self.cell.traced.contains(light) {
            LightAnswer::Traced
        } else {
            LightAnswer::Hidden
        }
    }

    /// Calls `found` with each of [`World::for_each_light_ray`] and what becomes of it.
    pub(crate) fn for_each_ray(
        &self,
        light: u32,
        points: &LightPoints<'_>,
        mut found: impl FnMut(&LightRay, RayAnswer),
    ) {
        let answer = self.of(light);
        let list = self.list(light);
        self.world.for_each_light_ray(light, points, |ray| {
            let is_blocked = |list: &LightList| {
                let rays = RayPacket::new(&[ray.ray]);
                self.lists.blocked(list, &rays, self.world.cutout()) != 0
            };
            let fate = match answer {
                LightAnswer::Hidden => RayAnswer::Withheld,
                LightAnswer::Traced => RayAnswer::Traced,
                // It carries more than what is known of a whole cell can answer for.
                _ if ray.exact => RayAnswer::Traced,
                _ if list.is_some_and(is_blocked) => RayAnswer::Withheld,
                _ => RayAnswer::Shown,
            };
            found(&ray, fate);
        });
    }
}
