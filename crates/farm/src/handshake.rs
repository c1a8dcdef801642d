//! How connections open, from both sides.

use lie_protocol::{Hello, Message, Opening, PROTOCOL_VERSION, Refuse, Role, Text};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    time::timeout,
};

use crate::connection::{HANDSHAKE_DEADLINE, LinkError, Receiver, Sender};

/// The build, for people on the other side.
#[must_use]
pub fn build() -> Text {
    Text::new(concat!("lie ", env!("CARGO_PKG_VERSION")))
}

/// A hello of this build.
#[must_use]
pub fn hello(role: Role, threads: u32, listen_port: u16) -> Hello {
    Hello {
        protocol_version: PROTOCOL_VERSION,
        role,
        threads,
        listen_port,
        build: build(),
    }
}

/// Waits for a hello, within the deadline. A peer of another version is told so.
///
/// # Errors
/// [`LinkError`]; the connection is to be dropped.
pub async fn await_hello<R, W>(
    receiver: &mut Receiver<R>,
    sender: &mut Sender<W>,
) -> Result<Hello, LinkError>
where
    R: AsyncRead + Unpin,
    W: AsyncWrite + Unpin,
{
    let opening = timeout(HANDSHAKE_DEADLINE, receiver.receive::<Opening>())
        .await
        .map_err(|_| LinkError::Silent(HANDSHAKE_DEADLINE))??;
    match opening {
        Opening::Hello(hello) => match hello.check_version(build().as_str()) {
            Ok(()) => Ok(hello),
            Err(refusal) => Err(refuse(sender, refusal).await),
        },
        Opening::Refuse(refusal) => Err(LinkError::Refused(refusal.reason)),
    }
}

/// Tells the peer why it is not welcome; returns the same as an error for the log.
pub async fn refuse<W: AsyncWrite + Unpin>(sender: &mut Sender<W>, refusal: Refuse) -> LinkError {
    let error = LinkError::Rules(format!("refused: {}", refusal.reason));
    match sender.send(&Opening::Refuse(refusal)).await {
        Ok(()) => error,
        Err(failed) => failed,
    }
}

/// Says hello and waits for the first answer, within the deadline.
///
/// # Errors
/// [`LinkError`]; the connection is to be dropped.
pub async fn greet<M, R, W>(
    receiver: &mut Receiver<R>,
    sender: &mut Sender<W>,
    hello: Hello,
) -> Result<M, LinkError>
where
    M: Message,
    R: AsyncRead + Unpin,
    W: AsyncWrite + Unpin,
{
    timeout(HANDSHAKE_DEADLINE, async {
        sender.send(&Opening::Hello(hello)).await?;
        receiver.receive().await
    })
    .await
    .map_err(|_| LinkError::Silent(HANDSHAKE_DEADLINE))?
}
