//! Pictures of a camera that somebody moves: of what is put in, only the newest is ever asked for.

use std::time::{Duration, Instant};

use lie_scene::Camera;
use tokio::sync::watch;

use crate::client::{Client, ClientError, Frame, FrameRequest};

/// Where somebody wants to look.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The view.
    pub camera: Camera,
    /// When it was put in.
    pub at: Instant,
}

/// How frames follow a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct SteerConfig {
    /// Everything about a frame but its camera.
    pub frame: FrameRequest,
    /// If set, a frame that has been in work for so long is given up once there is a newer
    /// input. The one after it is finished in any case: however fast inputs follow each other, there are
    /// pictures. Without, every frame is finished.
    pub patience: Option<Duration>,
}

/// A frame, and what was put in for it.
#[derive(Clone, Debug, PartialEq)]
pub struct SteeredFrame {
    /// What it is of.
    pub input: Input,
    /// When it was asked for.
    pub asked: Instant,
    /// The pixels, and how they came about.
    pub frame: Frame,
    /// Frames before it that were given up since the last that was finished: 0 or 1.
    pub given_up: u32,
}

/// Renders what is put in until nothing can be put in any more, and after that the last of it.
/// `show` is called on this task and may take its time: do not run this on a runtime's worker.
///
/// # Errors
/// [`ClientError`].
pub async fn steer(
    client: &mut Client,
    mut inputs: watch::Receiver<Option<Input>>,
    config: &SteerConfig,
    mut show: impl FnMut(SteeredFrame),
) -> Result<(), ClientError> {
    let mut given_up = 0;
    while inputs.changed().await.is_ok() {
        let Some(input) = inputs.borrow_and_update().clone() else {
            continue;
        };
        let request = FrameRequest {
            camera: input.camera.clone(),
            ..config.frame.clone()
        };
        client.set_camera(&request.camera, request.size);
        let asked = Instant::now();
        let patience = config.patience.filter(|_| given_up == 0);
        let frame = tokio::select! {
            frame = client.render_frame(&request) => frame?,
            () = stale(&mut inputs, patience) => {
                given_up += 1;
                continue;
            }
        };
        show(SteeredFrame {
            input,
            asked,
            frame,
            given_up: std::mem::take(&mut given_up),
        });
    }
    Ok(())
}

/// Waits until a frame is to be given up, which may be never. What makes it stale is still
/// news afterwards.
async fn stale(inputs: &mut watch::Receiver<Option<Input>>, patience: Option<Duration>) {
    let Some(patience) = patience else {
        return std::future::pending().await;
    };
    tokio::time::sleep(patience).await;
    if inputs.changed().await.is_err() {
        return std::future::pending().await;
    }
    inputs.mark_changed();
}
