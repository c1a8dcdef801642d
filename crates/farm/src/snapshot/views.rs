use glam::{Quat, UVec2, Vec3};
use lie_protocol::codec;
use lie_scene::{Camera, RenderSettings};
use serde::{Deserialize, Serialize};

use crate::{
    PastView, Snapshot, View,
    construct::{Finding, MOST_VIEWS},
};

/// Most memory that views may claim when they are read, in bytes.
const CLAIM: usize = 1 << 24;

/// What was looked at to learn a tree.
#[derive(Serialize, Deserialize)]
struct Description {
    proofs: bool,
    views: Vec<ViewDescription>,
}

#[derive(Serialize, Deserialize)]
struct ViewDescription {
    eye: [f32; 3],
    orientation: [f32; 4],
    vertical_fov: f32,
    size: [u32; 2],
    epoch: u64,
    passes: u32,
    /// Error and share in doubt of the last two passes.
    last: [Option<[f32; 2]>; 2],
    typical: f32,
    version: u64,
}

/// Views that were read.
pub(super) struct Views {
    pub(super) proofs: bool,
    pub(super) views: Vec<PastView>,
}

/// A snapshot but for its tree.
pub(super) fn encode(snapshot: &Snapshot) -> Result<Vec<u8>, String> {
    let description = Description {
        proofs: snapshot.proofs,
        views: snapshot.views.iter().map(describe).collect(),
    };
    let mut out = vec![];
    codec::write(&description, &mut out)?;
    Ok(out)
}

/// What [`encode`] was given.
pub(super) fn decode(bytes: &[u8]) -> Result<Views, String> {
    let description = match codec::read_within::<Description, CLAIM>(bytes)? {
        (description, []) => description,
        _ => return Err("bytes follow their end".to_owned()),
    };
    if description.views.len() > MOST_VIEWS {
        return Err("there are too many".to_owned());
    }
    let views: Option<_> = description.views.iter().map(view).collect();
    Ok(Views {
        proofs: description.proofs,
        views: views.ok_or("one is not possible")?,
    })
}

fn describe(past: &PastView) -> ViewDescription {
    let camera = &past.view.camera;
    ViewDescription {
        eye: camera.eye.to_array(),
        orientation: camera.orientation.to_array(),
        vertical_fov: camera.vertical_fov,
        size: past.view.size.to_array(),
        epoch: past.epoch,
        passes: past.passes,
        last: past
            .last
            .map(|found| found.map(|found| [found.error, found.doubtful])),
        typical: past.typical,
        version: past.version,
    }
}

/// A view, if there can be one.
fn view(description: &ViewDescription) -> Option<PastView> {
    let camera = Camera {
        name: String::new(),
        eye: Vec3::from(description.eye),
        orientation: Quat::from_array(description.orientation),
        vertical_fov: description.vertical_fov,
    };
    let finding = |[error, doubtful]: [f32; 2]| Finding { error, doubtful };
    let sides = 1..=RenderSettings::MAX_SIDE;
    let is_possible = camera.is_valid()
        && description.size.iter().all(|side| sides.contains(side))
        && description.typical.is_finite();
    is_possible.then(|| PastView {
        view: View {
            camera,
            size: UVec2::from(description.size),
        },
        epoch: description.epoch,
        passes: description.passes,
        last: description.last.map(|found| found.map(finding)),
        typical: description.typical,
        version: description.version,
    })
}
