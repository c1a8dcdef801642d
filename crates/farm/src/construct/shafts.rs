use std::{collections::HashMap, sync::Arc};

use glam::Vec3;
use lie_accel::{BoxShaft, Shaft};
use lie_geom::{Aabb, OFFSET_ULPS, Triangle, offset_origin};
use lie_octree::Between;
use lie_render::World;
use lie_scene::{AreaLight, Light, LightKind, Scene};

/// The shafts between a scene's lights and boxes.
pub(super) struct Shafts {
    world: Arc<World>,
    /// Box around the scene.
    bounds: Aabb,
    /// For each light where its shadow rays end.
    targets: Vec<Target>,
    /// For each light the triangles of the scene that it is, if they lie in one plane. Shadow rays end
    /// off that plane, on the side that they come from, and never meet them.
    own: Vec<Vec<u32>>,
}

/// Where the shadow rays to a light end.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// In one place.
    Place(Vec3),
    /// Somewhere in a box.
    Box(Aabb),
    /// So far away from where they start.
    Away(Vec3),
}

/// All segments from a light to a box.
pub(super) enum LightShaft {
    Place(Shaft),
    Boxes(BoxShaft),
}

impl Shafts {
    /// Those of a world.
    pub(super) fn new(world: Arc<World>) -> Self {
        let scene = world.scene();
        let reach = world.reach();
        let target = |light: &Light| match &light.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                Target::Place(*position)
            }
            LightKind::Directional { direction, .. } => Target::Away(-*direction * reach),
            LightKind::Area(area) => Target::Box(targets(area)),
        };
        Self {
            bounds: scene.geometry.bounds(),
            targets: scene.lights.iter().map(target).collect(),
            own: own_triangles(scene),
            world,
        }
    }

    /// Whether any light is in one place.
    pub(super) fn has_places(&self) -> bool {
        let is_place = |target: &Target| matches!(target, Target::Place(_));
        self.targets.iter().any(is_place)
    }

    /// Where the shadow rays to a light end.
    pub(super) fn target(&self, light: u32) -> Target {
        self.targets[light as usize]
    }

    /// Triangles that are the light itself and never in its way.
    pub(super) fn own(&self, light: u32) -> &[u32] {
        &self.own[light as usize]
    }

    /// All segments from a light to a box.
    pub(super) fn to(&self, target: Target, ends: Aabb) -> LightShaft {
        match target {
            Target::Place(place) => LightShaft::Place(Shaft::new(place, ends, self.bounds)),
            Target::Box(bounds) => LightShaft::Boxes(BoxShaft::new(ends, bounds, self.bounds)),
            Target::Away(way) => {
                // Rays aim from the surface itself, and start a little off it.
                let room = 1.0e-4 * self.world.reach();
                let far = Aabb {
                    min: ends.min + way - room,
                    max: ends.max + way + room,
                };
                LightShaft::Boxes(BoxShaft::new(ends, far, self.bounds))
            }
        }
    }
}

impl LightShaft {
    /// Adds the triangles in it to `found`, up to `limit` in all. Says whether these are all.
    pub(super) fn inside(&self, world: &World, limit: usize, found: &mut Vec<u32>) -> bool {
        match self {
            Self::Place(shaft) => world.accel().inside(shaft, limit, found),
            Self::Boxes(shaft) => world.accel().inside_boxes(shaft, limit, found),
        }
    }

    fn may_hit(&self, triangle: &Triangle) -> bool {
        match self {
            Self::Place(shaft) => shaft.may_hit(triangle),
            Self::Boxes(shaft) => shaft.may_hit(triangle),
        }
    }
}

impl Between for Shafts {
    fn between(&self, light: u32, ends: Aabb) -> impl Fn(u32) -> bool {
        let shaft = self.to(self.target(light), ends);
        let shapes = self.world.scene().geometry.shapes();
        move |triangle| shaft.may_hit(&shapes[triangle as usize])
    }
}

/// For each light its triangles in the scene, where they lie in one plane.
fn own_triangles(scene: &Scene) -> Vec<Vec<u32>> {
    let mut own = vec![vec![]; scene.lights.len()];
    let mut emitters: HashMap<[u32; 9], usize> = HashMap::new();
    for (index, light) in scene.lights.iter().enumerate() {
        if let LightKind::Area(area) = &light.kind
            && is_flat(area)
        {
            let keys = area.triangles().iter().map(bits);
            emitters.extend(keys.map(|key| (key, index)));
        }
    }
    if !emitters.is_empty() {
        for (triangle, shape) in (0..).zip(scene.geometry.shapes()) {
            if let Some(&light) = emitters.get(&bits(shape)) {
                own[light].push(triangle);
            }
        }
    }
    own
}

fn bits(triangle: &Triangle) -> [u32; 9] {
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| corner.to_array());
    std::array::from_fn(|place| corners[place / 3][place % 3].to_bits())
}

/// Whether a light lies in one plane, to within what shadow rays keep away from it.
fn is_flat(area: &AreaLight) -> bool {
    let Some(first) = area.triangles().first() else {
        return false;
    };
    let extent = first.extent();
    area.triangles().iter().all(|triangle| {
        let corners = [triangle.a, triangle.b, triangle.c];
        corners.into_iter().all(|corner| {
            let away = (corner - first.a).dot(first.normal).abs();
            let room = 0.25 * OFFSET_ULPS * (corner.abs().max_element() + extent);
            away <= room && triangle.normal.dot(first.normal).abs() > 0.999
        })
    })
}

/// A box around all points of an area light that shadow rays go to: a little in front of it.
fn targets(area: &AreaLight) -> Aabb {
    let corners = area.triangles().iter().flat_map(|triangle| {
        let extent = triangle.extent();
        [triangle.a, triangle.b, triangle.c]
            .into_iter()
            .flat_map(move |corner| {
                let sides = if area.double_sided {
                    &[1.0, -1.0][..]
                } else {
                    &[1.0]
                };
                let off = move |side: &f32| offset_origin(corner, *side * triangle.normal, extent);
                sides.iter().map(off)
            })
    });
    Aabb::around(corners)
}
