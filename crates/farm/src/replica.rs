use std::{collections::HashSet, sync::Arc};

use glam::Vec3;
use lie_geom::Aabb;
use lie_octree::{CellBody, CellKey, CellState, Cube, LieSettings, LieState, LieTree, Replica};
use lie_render::{LieCell, LieLookup, World};

/// A shader's copy of the LIEs, compiled for shading, under construction.
///
/// [`Self::publish`] hands out a picture of it that never moves: frames are rendered from
/// one while the next is applied.
pub struct LieReplica {
    world: Arc<World>,
    settings: LieSettings,
    replica: Replica<LieCell>,
}

/// LIEs of one version, ready to be rendered with.
pub struct PublishedLies(Replica<LieCell>);

/// Why a cell could not be applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplicaError {
    /// A cell refers to a light that the scene does not have.
    #[error("a cell refers to light {0}, which the scene does not have")]
    Light(u32),
    /// A cell refers to a triangle that the scene does not have.
    #[error("a cell refers to triangle {0}, which the scene does not have")]
    Triangle(u32),
}

impl LieReplica {
    /// A copy that knows nothing. `settings` are those of the constructor's tree.
    #[must_use]
    pub fn new(world: Arc<World>, settings: LieSettings) -> Self {
        let cube = Cube::around(world.scene().geometry.bounds());
        // Of a cell that nothing is known of every light is traced, wherever the cell is.
        let everywhere = cube.cell_bounds(CellKey::ROOT);
        let empty = compile(&world, settings, everywhere, &LieState::default());
        Self {
            world,
            settings,
            replica: Replica::new(cube, empty),
        }
    }

    /// The whole of a constructor's tree.
    #[must_use]
    pub fn of(world: Arc<World>, tree: &LieTree) -> Self {
        let mut copy = Self::new(world, tree.settings());
        for state in tree.keys().into_iter().filter_map(|key| tree.state(key)) {
            copy.take(&state);
        }
        copy.replica.reached(tree.version());
        copy
    }

    /// Takes in cells, after which the copy equals the constructor's `to_version`.
    ///
    /// # Errors
    /// [`ReplicaError`] if a cell does not fit the scene; the copy is then as it was.
    pub fn apply(&mut self, states: &[CellState], to_version: u64) -> Result<(), ReplicaError> {
        states.iter().try_for_each(|state| self.check(state))?;
        for state in states {
            self.take(state);
        }
        self.replica.reached(to_version);
        Ok(())
    }

    /// Takes in a cell that fits the scene.
    fn take(&mut self, state: &CellState) {
        let bounds = self.replica.cube().cell_bounds(state.key);
        let everything = match self.settings.trust {
            0 => 0,
            _ => self.world.scene().lights.len(),
        };
        self.replica.apply_or_share(state, |lie| {
            let cell = compile(&self.world, self.settings, bounds, lie);
            (cell.answered() > 0 || cell.traced.len() != everything).then_some(cell)
        });
    }

    /// The version that it equals.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.replica.version()
    }

    /// The LIEs as they are now. Costs nothing: unchanged cells are shared.
    #[must_use]
    pub fn publish(&self) -> PublishedLies {
        PublishedLies(self.replica.clone())
    }

    fn check(&self, state: &CellState) -> Result<(), ReplicaError> {
        let CellBody::Leaf(lie) = &state.body else {
            return Ok(());
        };
        let scene = self.world.scene();
        let mut named = lie.hidden.iter().chain(&lie.crowded);
        if let Some(&light) = named.find(|&&light| light as usize >= scene.lights.len()) {
            return Err(ReplicaError::Light(light));
        }
        for entry in &lie.lights {
            if entry.light as usize >= scene.lights.len() {
                return Err(ReplicaError::Light(entry.light));
            }
            let beyond = |&&triangle: &&u32| triangle as usize >= scene.geometry.len();
            if let Some(&triangle) = entry.occluders.iter().find(beyond) {
                return Err(ReplicaError::Triangle(triangle));
            }
        }
        Ok(())
    }
}

impl PublishedLies {
    /// The constructor's version that they equal.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.0.version()
    }

    /// A cell, or what is known of places that no cell's region takes in: nothing.
    fn holding<'a>(&'a self, point: Vec3, cell: &'a LieCell) -> &'a LieCell {
        match cell.region {
            Some(region) if !region.contains(point) => self.0.empty(),
            _ => cell,
        }
    }

    /// Memory of all compiled cells in bytes; takes time in proportion to their number.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let mut bytes = 0;
        let mut counted = HashSet::new();
        self.0.for_each_leaf(|_, cell| {
            if !self.0.is_empty_leaf(cell) && counted.insert(std::ptr::from_ref(cell)) {
                bytes += cell.bytes() as u64;
            }
        });
        bytes
    }
}

impl LieLookup for PublishedLies {
    fn cell(&self, point: Vec3) -> &LieCell {
        self.holding(point, self.0.leaf_at(point))
    }

    fn cells<'a>(&'a self, points: &[Vec3], found: &mut Vec<&'a LieCell>) {
        let each = |point, cell| found.push(self.holding(point, cell));
        self.0.for_each_leaf_at(points.iter().copied(), each);
    }
}

/// The LIE of a cell with these bounds, in the form that shading wants. The caller has checked
/// its indices. What is in doubt is traced, unless the light cannot reach the cell at all.
fn compile(world: &World, settings: LieSettings, bounds: Aabb, lie: &LieState) -> LieCell {
    let scene = world.scene();
    let is_known = |light: &u32| {
        lie.lights
            .binary_search_by_key(light, |entry| entry.light)
            .is_ok()
            || lie.hidden.binary_search(light).is_ok()
    };
    let traced = if settings.trust == 0 {
        lie.crowded.iter().copied().collect()
    } else {
        (0..scene.lights.len() as u32)
            .filter(|light| !is_known(light))
            .filter(|&light| scene.lights[light as usize].may_reach(lie.region.unwrap_or(bounds)))
            .collect()
    };
    let lights = lie.lights.iter();
    let lights = lights.map(|entry| (entry.light, &entry.occluders[..]));
    LieCell {
        region: lie.region,
        ..LieCell::new(lights, traced)
    }
}
