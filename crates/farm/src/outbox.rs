//! What a session has to say, one message after the other, with signs of life between.

use lie_protocol::{Goodbye, Message, Ping, Text};
use tokio::{
    io::AsyncWrite,
    sync::mpsc,
    time::{Interval, MissedTickBehavior, interval},
};
use tokio_util::sync::CancellationToken;

use crate::connection::{LinkError, PING_EVERY, Sender};

/// A direction in which signs of life and farewells exist.
pub trait Session: Message {
    /// A sign of life.
    fn ping(ping: Ping) -> Self;
    /// A farewell.
    fn goodbye(goodbye: Goodbye) -> Self;
}

macro_rules! session {
    ($($name:ident),*) => { $(
        impl Session for lie_protocol::$name {
            fn ping(ping: Ping) -> Self {
                Self::Ping(ping)
            }

            fn goodbye(goodbye: Goodbye) -> Self {
                Self::Goodbye(goodbye)
            }
        }
    )* };
}
session!(
    ConstructorToShader,
    ShaderToConstructor,
    ConstructorToClient,
    ClientToConstructor,
    ShaderToClient,
    ClientToShader
);

/// The rhythm of signs of life.
#[must_use]
pub fn heartbeat() -> Interval {
    let mut ticks = interval(PING_EVERY);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

/// Says farewell; the connection closes whether or not it is heard.
pub async fn say_goodbye<M: Session, W: AsyncWrite + Unpin>(sender: &mut Sender<W>, reason: &str) {
    let reason = Text::new(reason);
    // The peer finds out from the closed connection if this does not reach it.
    let _ = sender.send(&M::goodbye(Goodbye { reason })).await;
}

/// Sends what comes out of the box until all senders into it are gone or `shutdown` says
/// so, then says goodbye. `keep` decides at the last moment whether a message still counts.
///
/// # Errors
/// [`LinkError`] when the connection fails.
pub async fn drain<M: Session, W: AsyncWrite + Unpin>(
    sender: &mut Sender<W>,
    mut messages: mpsc::Receiver<M>,
    shutdown: &CancellationToken,
    keep: impl Fn(&M) -> bool,
) -> Result<(), LinkError> {
    let mut heartbeat = heartbeat();
    let mut nonce = 0;
    loop {
        tokio::select! {
            message = messages.recv() => match message {
                Some(message) if keep(&message) => sender.send(&message).await?,
                Some(_) => {}
                None => break,
            },
            _ = heartbeat.tick() => {
                nonce += 1;
                sender.send(&M::ping(Ping { nonce })).await?;
            }
            () = shutdown.cancelled() => break,
        }
    }
    say_goodbye::<M, W>(sender, "the process is ending").await;
    Ok(())
}
