use crate::{LitLight, Outcome, lie::QUARTER, observer::ASKED_FIRST};

/// What the constructor knows of a light from a cell. Counts stop at the largest that fits.
#[derive(Clone, Debug, PartialEq)]
pub struct LightEvidence {
    /// Number of the light in the scene.
    pub light: u32,
    /// Rays that reached it.
    pub clear: u16,
    /// Rays that did not.
    pub blocked: u16,
    /// Rays that agreed with what was known, since one last added to it.
    pub agreed: u16,
    /// Largest [`Outcome::importance`] so far, in parts of 255, rounded up.
    pub(crate) importance: u8,
    /// Whether it reached the cell that this one was split from. That counts until there
    /// are rays enough from this one.
    pub inherited: bool,
    /// Whether too much is in the way to list: its rays go through the scene.
    pub crowded: bool,
    /// Largest luminance that it may have given any of the cell's own samples.
    pub most: f32,
    /// Largest luminance that it was kept from giving any of them.
    pub withheld: f32,
    /// What shaders make of it, if other lights outshine it so much that its shadows are not
    /// seen (LIE §5).
    pub mask: Option<Mask>,
    /// The triangles that came in between, in the order of their discovery. Of a hidden
    /// light, some of them; of a crowded one, none.
    pub occluders: Vec<Occluder>,
}

/// How a light is shaded whose shadows nobody sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mask {
    /// Not at all, as if it were hidden everywhere.
    LeftOut,
    /// As if nothing were in its way.
    Whole,
}

/// A triangle that blocks a light somewhere in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occluder(u32);

impl Occluder {
    const CONFIRMED: u32 = 1 << 31;

    /// A triangle below 2³¹.
    pub(crate) fn new(triangle: u32, is_confirmed: bool) -> Self {
        let inherited = Self(triangle).inherited();
        if is_confirmed {
            Self(inherited.0 | Self::CONFIRMED)
        } else {
            inherited
        }
    }

    fn confirmed(triangle: u32) -> Self {
        Self(triangle | Self::CONFIRMED)
    }

    fn inherited(self) -> Self {
        Self(self.triangle())
    }

    /// Index in the scene, which has fewer than 2³¹.
    #[must_use]
    pub fn triangle(self) -> u32 {
        self.0 & !Self::CONFIRMED
    }

    /// Whether it was found to block a ray from this very cell; else it is known from the one
    /// that this was split from.
    #[must_use]
    pub fn is_confirmed(self) -> bool {
        self.0 & Self::CONFIRMED != 0
    }
}

impl LightEvidence {
    /// Rays from a cell after which what it inherited and they did not confirm is dropped.
    pub(crate) const SETTLED: u16 = 256;

    /// Rays from a cell after which its parts do not inherit what it inherited and they did not
    /// confirm.
    const CONFIRMED: u16 = 32;

    pub(crate) fn new(light: u32) -> Self {
        Self {
            light,
            clear: 0,
            blocked: 0,
            agreed: 0,
            importance: 0,
            inherited: false,
            crowded: false,
            most: 0.0,
            withheld: 0.0,
            mask: None,
            occluders: vec![],
        }
    }

    /// What holds in a part of the cell. A plane through a cell leaves a surface about a
    /// quarter of its rays. What masks a light may lie in another part: it starts unmasked.
    /// What it inherited itself, and enough rays did not confirm, is not handed on; nor is more of what hides a light than is asked first.
    pub(crate) fn part(&self) -> Self {
        let is_known = self.own_rays() >= Self::CONFIRMED;
        let handed_on = |occluder: &Occluder| occluder.is_confirmed() || !is_known;
        let is_listed = self.is_lit() && !self.crowded;
        let limit = if is_listed { usize::MAX } else { ASKED_FIRST };
        let occluders = self.occluders.iter().copied();
        let occluders = occluders.filter(handed_on).take(limit);
        Self {
            clear: 0,
            blocked: 0,
            agreed: self.agreed / QUARTER as u16,
            most: 0.0,
            withheld: 0.0,
            mask: None,
            inherited: self.is_lit(),
            occluders: occluders.map(Occluder::inherited).collect(),
            ..*self
        }
    }

    /// Keeps of what may be in the way that which can be.
    pub(crate) fn narrow(&mut self, may_block: impl Fn(u32) -> bool) {
        self.occluders
            .retain(|occluder| may_block(occluder.triangle()));
    }

    /// Whether it reaches the cell, as far as is known.
    pub(crate) fn is_lit(&self) -> bool {
        self.clear > 0 || self.inherited
    }

    /// Whether it is crowded for good: nothing is left to learn.
    pub(crate) fn is_past_listing(&self) -> bool {
        self.crowded && !self.inherited
    }

    /// Draws the conclusions from what was counted.
    pub(crate) fn settle(&mut self, crowd: u32) {
        let confirmed = self.occluders.iter().filter(|own| own.is_confirmed());
        let is_crowd = self.clear > 0 && confirmed.count() > crowd as usize;
        if self.inherited && (self.own_rays() >= Self::SETTLED || is_crowd) {
            // There are rays enough to drop what they did not confirm.
            self.inherited = false;
            self.occluders.retain(|own| own.is_confirmed());
            self.crowded = self.is_lit() && self.occluders.len() > crowd as usize;
            if self.clear == 0 {
                self.agreed = self.blocked;
            }
        } else if self.is_lit() && self.occluders.len() > crowd as usize {
            self.crowded = true;
        }
        if self.is_past_listing() {
            self.occluders = vec![];
        }
    }

    /// Occluders that were seen to block a ray from this very cell; more than `crowd` of a crowded
    /// light.
    pub(crate) fn confirmed(&self, crowd: u32) -> usize {
        if self.is_past_listing() {
            return crowd as usize + 1;
        }
        let confirmed = self.occluders.iter().filter(|own| own.is_confirmed());
        confirmed.count()
    }

    /// Rays from this very cell.
    pub(crate) fn own_rays(&self) -> u16 {
        self.clear.saturating_add(self.blocked)
    }

    /// Takes in that it would give a sample so large a share of its light.
    pub(crate) fn matter(&mut self, importance: f32) {
        // `as` saturates.
        self.importance = self.importance.max((importance * 255.0).ceil() as u8);
    }

    /// Whether as many rays agree as the light's importance asks for: in proportion to it,
    /// so that what may be wrong of any light is worth about the same; but at least a
    /// sixteenth.
    pub(crate) fn is_trusted(&self, trust: u32) -> bool {
        self.is_enough(self.agreed, trust)
    }

    /// Whether so many rays are as many as its importance asks for.
    pub(crate) fn is_enough(&self, rays: u16, trust: u32) -> bool {
        f32::from(rays) >= self.needed(trust)
    }

    /// Rays that its importance asks for.
    pub(crate) fn needed(&self, trust: u32) -> f32 {
        let importance = f32::from(self.importance) / 255.0;
        let needed = trust as f32 * importance.clamp(1.0 / 16.0, 1.0);
        needed.min(f32::from(u16::MAX))
    }

    /// Rays that reached the light.
    pub(crate) fn see(&mut self, rays: u32) {
        if !self.is_lit() {
            self.agreed = 0;
        }
        let rays = saturated(rays);
        self.clear = self.clear.saturating_add(rays);
        self.agreed = self.agreed.saturating_add(rays);
    }

    /// Rays that a triangle blocked.
    pub(crate) fn block(&mut self, triangle: u32, rays: u32, crowd: u32) {
        let rays = saturated(rays);
        self.blocked = self.blocked.saturating_add(rays);
        self.agreed = self.agreed.saturating_add(rays);
        let mut known = self.occluders.iter_mut();
        if let Some(known) = known.find(|known| known.triangle() == triangle) {
            *known = Occluder::confirmed(triangle);
        } else if self.is_lit() || self.occluders.len() < crowd as usize {
            self.occluders.push(Occluder::confirmed(triangle));
            if self.is_lit() {
                self.agreed = 0;
            }
        }
    }

    /// Rays so far were wrong about it: as many must agree again.
    pub(crate) fn distrust(&mut self) {
        self.agreed = 0;
    }

    /// Takes in what a sample had of it, and what it was kept from having.
    pub(crate) fn weigh(&mut self, outcomes: &[Outcome]) {
        let given: f32 = outcomes.iter().map(|outcome| outcome.luminance).sum();
        let beside = outcomes.iter().map(|outcome| outcome.beside);
        self.most = self.most.max(given + beside.fold(0.0, f32::max));
        let withheld = outcomes.iter().map(|outcome| outcome.withheld).sum();
        self.withheld = self.withheld.max(withheld);
    }

    pub(crate) fn to_lit(&self) -> LitLight {
        let occluders = match self.mask {
            Some(Mask::Whole) => &[],
            _ => &self.occluders[..],
        };
        LitLight {
            light: self.light,
            occluders: occluders.iter().map(|known| known.triangle()).collect(),
        }
    }
}

fn saturated(count: u32) -> u16 {
    u16::try_from(count).unwrap_or(u16::MAX)
}
