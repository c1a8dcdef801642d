//! One pixel under the magnifying glass: why it is as bright as it is, and what that costs.

mod names;
mod report;

use glam::{UVec2, Vec3};
use lie_geom::Aabb;
use lie_octree::{Lie, LieTree, LightEvidence, Mask, Odds, Proof, Standing};
use lie_render::{
    ExpectedError, FrameSettings, LieLookup, LightAnswer, LightShare, PixelLight, RayOdds, World,
    luminance,
};
use lie_scene::{Camera, Surface};

use self::names::Names;
pub use self::report::{
    Answer, BoundsReport, CellReport, EvidenceReport, LightClass, LightReport, OccluderReport,
    PixelReport, SeenReport, SurfaceReport, TotalsReport, TriangleReport,
};

/// There is no such pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pixel {},{} is outside of the picture, {} x {}: columns are 0 to {}, rows 0 to {}",
    pixel.x, pixel.y, size.x, size.y, size.x - 1, size.y - 1)]
pub struct OutsidePicture {
    /// The pixel asked for.
    pub pixel: UVec2,
    /// Columns and rows of the picture.
    pub size: UVec2,
}

/// Looks at one pixel: its cell, and of each light what is known of it there, what it gives, and
/// what shaders make of it. `lies` are what shaders know of `tree`. The pixel is that of a frame
/// with these settings and one camera ray to a pixel, through its centre.
///
/// # Errors
/// [`OutsidePicture`] if there is no such pixel.
pub fn inspect(
    world: &World,
    tree: &LieTree,
    lies: &dyn LieLookup,
    camera: &Camera,
    settings: &FrameSettings,
    pixel: UVec2,
) -> Result<PixelReport, OutsidePicture> {
    let size = settings.size;
    if pixel.cmpge(size).any() {
        return Err(OutsidePicture { pixel, size });
    }
    let settings = FrameSettings {
        samples_per_pixel: 1,
        ..*settings
    };
    let light = PixelLight::of(world, lies, camera, &settings, pixel);
    Ok(PixelReport {
        camera: camera.name.clone(),
        size: size.into(),
        pixel: pixel.into(),
        samples: tree.samples(),
        version: tree.version(),
        trust: tree.settings().trust,
        seen: light.map(|light| seen(world, tree, &light)),
    })
}

fn seen(world: &World, tree: &LieTree, light: &PixelLight) -> SeenReport {
    let names = Names::of(world.scene());
    let lie = tree.lie_at(light.surface.shadow_origin);
    let inspector = Inspector {
        names,
        lie: &lie,
        trust: tree.settings().trust,
    };
    let lights = light.lights.iter();
    SeenReport {
        surface: inspector.surface(&light.surface, light),
        cell: cell(tree, &lie, light.surface.shadow_origin),
        lights: lights.map(|share| inspector.light(share)).collect(),
        totals: inspector.totals(&light.lights),
    }
}

fn cell(tree: &LieTree, lie: &Lie, point: Vec3) -> CellReport {
    let key = tree.key_at(point);
    let region = lie.region();
    CellReport {
        path: key.path().collect(),
        depth: key.depth(),
        bounds: bounds(tree.cube().cell_bounds(key)),
        region: (!region.bounds.is_empty()).then(|| bounds(region.bounds)),
        holds: tree.settings().trust == 0 || region.bounds.contains(point),
        samples: lie.samples(),
        dark_samples: lie.dark(),
        occluders: lie.listed() + region.listed(),
    }
}

fn bounds(bounds: Aabb) -> BoundsReport {
    BoundsReport {
        min: bounds.min.into(),
        max: bounds.max.into(),
    }
}

/// What all lights of a pixel share.
struct Inspector<'a> {
    names: Names<'a>,
    lie: &'a Lie,
    trust: u32,
}

impl Inspector<'_> {
    fn surface(&self, surface: &Surface, light: &PixelLight) -> SurfaceReport {
        let TriangleReport {
            triangle,
            mesh,
            material,
        } = self.names.triangle(surface.triangle);
        SurfaceReport {
            position: surface.position.into(),
            shadow_origin: surface.shadow_origin.into(),
            normal: surface.shading_normal.into(),
            distance: light.distance,
            triangle,
            mesh,
            material,
            emitted: light.emitted.into(),
        }
    }

    fn light(&self, share: &LightShare) -> LightReport {
        let light = share.light;
        let evidence = self.lie.evidence(light);
        let (name, kind) = self.names.light(light);
        let exact = luminance(share.exact);
        let mut expected = ExpectedError::default();
        self.expect(share, &mut expected);
        LightReport {
            light,
            name,
            kind,
            class: self.class(light),
            open: self.lie.region().proof(light) == Some(Proof::Open),
            answer: match share.answer {
                LightAnswer::Unoccluded => Answer::Unoccluded,
                LightAnswer::Listed(_) => Answer::List,
                LightAnswer::Traced => Answer::Traced,
                LightAnswer::Hidden => Answer::Hidden,
            },
            evidence: evidence.map(counts),
            needed: self.lie.needed(light, self.trust),
            exact: share.exact.into(),
            shaded: share.shaded.into(),
            luminance: exact,
            error: luminance(share.shaded) - exact,
            expected_error: expected.rms(),
            standard_rays: share.standard_rays,
            traced_rays: share.traced_rays,
            saved_rays: share.saved_rays(),
            list_rays: share.list_rays,
            occluder_tests: share.occluder_tests,
            occluders: self.occluders(light, evidence),
            missed: self.names.triangles(&share.missed),
        }
    }

    fn class(&self, light: u32) -> LightClass {
        match self.lie.standing(light, self.trust) {
            Standing::Certain => match self.lie.region().proof(light) {
                Some(Proof::Hidden) => LightClass::ProvenHidden,
                Some(Proof::Behind(_)) => LightClass::CompleteList,
                _ => LightClass::ProvenUnoccluded,
            },
            Standing::Lit(entry) => match entry.mask {
                Some(Mask::LeftOut) => LightClass::MaskedOut,
                Some(Mask::Whole) => LightClass::MaskedWhole,
                None => LightClass::Lit,
            },
            Standing::Hidden if self.lie.evidence(light).is_some() => LightClass::Hidden,
            Standing::Hidden => LightClass::Dark,
            Standing::Crowded => LightClass::Crowded,
            Standing::Doubtful => LightClass::Doubtful,
        }
    }

    fn occluders(&self, light: u32, evidence: Option<&LightEvidence>) -> Vec<OccluderReport> {
        let report = |triangle, confirmed| OccluderReport {
            triangle: self.names.triangle(triangle),
            confirmed,
        };
        match (self.lie.region().proof(light), evidence) {
            (Some(Proof::Behind(list)), _) => list
                .iter()
                .map(|triangle| report(triangle, false))
                .collect(),
            (_, Some(entry)) => entry
                .occluders
                .iter()
                .map(|known| report(known.triangle(), known.is_confirmed()))
                .collect(),
            _ => vec![],
        }
    }

    /// Adds what may be wrong of a light.
    fn expect(&self, share: &LightShare, error: &mut ExpectedError) {
        error.add(odds(self.lie, share.light, self.trust), share.at_stake);
    }

    fn totals(&self, lights: &[LightShare]) -> TotalsReport {
        let sum = |of: fn(&LightShare) -> Vec3| lights.iter().map(of).sum::<Vec3>();
        let count = |of: fn(&LightShare) -> u64| lights.iter().map(of).sum::<u64>();
        let (exact, shaded) = (sum(|share| share.exact), sum(|share| share.shaded));
        let mut expected = ExpectedError::default();
        lights
            .iter()
            .for_each(|share| self.expect(share, &mut expected));
        TotalsReport {
            exact: exact.into(),
            shaded: shaded.into(),
            luminance: luminance(exact),
            error: luminance(shaded) - luminance(exact),
            expected_error: expected.rms(),
            standard_rays: count(|share| share.standard_rays.into()),
            traced_rays: count(|share| share.traced_rays.into()),
            saved_rays: count(|share| share.saved_rays().into()),
            list_rays: count(|share| share.list_rays.into()),
            occluder_tests: count(|share| share.occluder_tests),
        }
    }
}

/// How likely it is that rays from a cell to a light are answered wrongly; `trust` is that of the
/// cell's tree.
#[must_use]
pub fn odds(lie: &Lie, light: u32, trust: u32) -> RayOdds {
    let Odds { one, two } = lie.odds(light, trust);
    RayOdds { one, two }
}

fn counts(entry: &LightEvidence) -> EvidenceReport {
    EvidenceReport {
        clear: entry.clear,
        blocked: entry.blocked,
        agreed: entry.agreed,
        inherited: entry.inherited,
    }
}

#[cfg(test)]
mod tests;
