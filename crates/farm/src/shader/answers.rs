//! What a shader says to its constructor whatever else is going on.

use lie_protocol::{ConstructorToShader as In, Ping, Pong, ShaderToConstructor as Out};
use tokio::sync::mpsc;

use crate::connection::LinkError;

/// Deals with what may come at any time.
pub(super) fn answer(message: In, outbox: &mpsc::Sender<Out>) -> Result<(), LinkError> {
    match message {
        In::Ping(Ping { nonce }) => {
            // A full box means that bytes are on their way: sign of life enough.
            let _ = outbox.try_send(Out::Pong(Pong { nonce }));
            Ok(())
        }
        In::Pong(_) => Ok(()),
        In::Goodbye(goodbye) => Err(LinkError::Refused(goodbye.reason)),
        In::Refuse(refusal) => Err(LinkError::Refused(refusal.reason)),
        // While the scene is on its way nothing else is expected, and afterwards no more of it.
        In::Welcome(_) | In::SceneChunk(_) | In::SceneReady(_) | In::LieDelta(_) => {
            Err(LinkError::Rules("a message at the wrong time".to_owned()))
        }
    }
}

/// Puts a message into the box, which never fills up unless the constructor takes nothing.
pub(super) fn post(outbox: &mpsc::Sender<Out>, message: Out) -> Result<(), LinkError> {
    outbox
        .try_send(message)
        .map_err(|_| LinkError::Rules("the constructor takes no messages".to_owned()))
}
