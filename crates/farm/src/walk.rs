//! Walkthroughs without a window.

use std::time::Duration;

use lie_scene::Walkthrough;

use crate::client::{Client, ClientError, Frame, FrameRequest};

/// A walk to take.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkConfig {
    /// The path; at least one key frame.
    pub path: Walkthrough,
    /// Frames, evenly spread in time from the path's first moment to its last.
    pub frames: u32,
    /// The first of them to ask for; those before it are left out.
    pub first: u32,
    /// If set, each frame waits until its view has converged, at most this long.
    pub settle: Option<Duration>,
    /// Everything about a frame but its camera.
    pub frame: FrameRequest,
}

/// Who sees the frames.
pub trait WalkObserver {
    /// What can go wrong with a frame.
    type Error;

    /// A frame is begun; `settled` is whether its view has converged, if that was asked for.
    fn begins(&mut self, index: u32, settled: Option<bool>);

    /// A frame is finished.
    ///
    /// # Errors
    /// Ends the walk.
    fn finished(&mut self, index: u32, frame: Frame) -> Result<(), Self::Error>;
}

/// Why a walk ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WalkError<E> {
    /// No picture.
    #[error(transparent)]
    Client(ClientError),
    /// The observer had enough.
    #[error("{0}")]
    Observer(E),
}

/// Walks. The observer is called on this task and may take its time: do not run this on a
/// runtime's worker.
///
/// # Errors
/// [`WalkError`].
pub async fn walk<O: WalkObserver>(
    client: &mut Client,
    config: &WalkConfig,
    observer: &mut O,
) -> Result<(), WalkError<O::Error>> {
    for index in config.first..config.frames {
        let share = f64::from(index) / f64::from(config.frames.saturating_sub(1).max(1));
        let time_s = (f64::from(config.path.duration_s()) * share) as f32;
        let request = FrameRequest {
            camera: config.path.camera_at(time_s),
            ..config.frame.clone()
        };
        let serial = client.set_camera(&request.camera, request.size);
        let settled = match config.settle {
            Some(timeout) => Some(client.settled(serial, timeout).await),
            None => None,
        };
        observer.begins(index, settled);
        let frame = client.render_frame(&request).await;
        let frame = frame.map_err(WalkError::Client)?;
        observer
            .finished(index, frame)
            .map_err(WalkError::Observer)?;
    }
    Ok(())
}
