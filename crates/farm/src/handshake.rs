//! How connections open, from both sides.

use lie_protocol::{Hello, Message, Opening, PROTOCOL_VERSION, ProtocolError, Refuse, Role, Text};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    time::timeout,
};

use crate::{
    connection::{HANDSHAKE_DEADLINE, LinkError, Receiver, Sender},
    secure::HandshakeFailure,
};

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
            Err(refusal) => Err(match refuse(sender, refusal).await {
                LinkError::NotTaken(reason) => LinkError::OtherVersion(reason),
                failed => failed,
            }),
        },
        Opening::Refuse(refusal) => Err(LinkError::Refused(refusal.reason)),
    }
}

/// Tells the peer why it is not welcome; returns the same as an error for the log.
pub async fn refuse<W: AsyncWrite + Unpin>(sender: &mut Sender<W>, refusal: Refuse) -> LinkError {
    let error = LinkError::NotTaken(refusal.reason.clone());
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
    let answer = timeout(HANDSHAKE_DEADLINE, async {
        sender.send(&Opening::Hello(hello)).await?;
        receiver.receive().await
    })
    .await
    .map_err(|_| LinkError::Silent(HANDSHAKE_DEADLINE))?;
    match answer {
        // A record of TLS: an alert, or part of a handshake.
        Err(LinkError::Protocol(ProtocolError::Magic([20..=23, 3, ..]))) => {
            Err(HandshakeFailure::UnexpectedTls.into())
        }
        answer => answer,
    }
}

/// The error of a refusal that answered our hello.
pub fn refused<R: AsyncRead + Unpin>(receiver: &Receiver<R>, refusal: Refuse) -> LinkError {
    match receiver.peer_version() {
        Some(PROTOCOL_VERSION) | None => LinkError::Refused(refusal.reason),
        Some(_) => LinkError::Version(refusal.reason),
    }
}
