//! Messages over any stream of bytes. What the stream is (TCP, with TLS or without) is nobody's
//! business here.

use std::{
    io::ErrorKind,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use lie_protocol::{Decoder, Message, ProtocolError, Text, encode};
use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    time::{Instant, timeout, timeout_at},
};

use crate::secure::HandshakeFailure;

/// How often each side shows that it lives.
pub const PING_EVERY: Duration = Duration::from_secs(1);
/// Silence (not a single byte) after which the peer counts as dead.
pub const DEAD_AFTER: Duration = Duration::from_secs(5);
/// How long a connection may take to be made and secured, up to the hello; and from there to the
/// answer.
pub const HANDSHAKE_DEADLINE: Duration = Duration::from_secs(5);

/// Room for one read, and most bytes moved by one write.
const PIECE: usize = 64 * 1024;

/// Why a connection ended.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LinkError {
    /// The network failed.
    #[error("the connection failed: {0}")]
    Io(std::io::Error),
    /// The two do not belong to one cluster, or one of them does not use TLS.
    #[error(transparent)]
    Handshake(#[from] HandshakeFailure),
    /// The peer is of another build.
    #[error("the peer says: {0}")]
    Version(Text),
    /// What came is no message, or what was to go is none.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// Nothing came for too long.
    #[error("nothing was heard for {} s", .0.as_secs_f32())]
    Silent(Duration),
    /// The peer did not take a single byte for too long.
    #[error("the peer took nothing for {} s", .0.as_secs_f32())]
    Stuck(Duration),
    /// The peer closed the connection.
    #[error("the peer closed the connection")]
    Closed,
    /// The peer did not let us in, or left with a word.
    #[error("the peer says: {0}")]
    Refused(Text),
    /// We did not let the peer in.
    #[error("refused: {0}")]
    NotTaken(Text),
    /// We did not let the peer in, since it is of another build.
    #[error("refused: {0}")]
    OtherVersion(Text),
    /// Others have got the place of one that did not say what it is.
    #[error("it said no hello while others waited for its place")]
    CrowdedOut,
    /// A well-formed message that breaks the rules.
    #[error("the peer broke the protocol: {0}")]
    Rules(String),
}

impl LinkError {
    /// Whether the peer cannot be talked to until somebody changes one of the two sides.
    #[must_use]
    pub fn is_lasting(&self) -> bool {
        match self {
            // What TLS fails by otherwise may have happened on the way.
            Self::Handshake(failure) => !matches!(failure, HandshakeFailure::Other(_)),
            Self::Version(_) => true,
            Self::Protocol(error) => {
                matches!(
                    error,
                    ProtocolError::Magic(_) | ProtocolError::Version { .. }
                )
            }
            _ => false,
        }
    }
}

impl From<std::io::Error> for LinkError {
    fn from(error: std::io::Error) -> Self {
        match HandshakeFailure::of(&error) {
            Some(failure) => Self::Handshake(failure),
            // A process that was killed takes no leave of TLS, and its system resets connections
            // on which it had something left to read. Nothing can be cut short by that: every
            // message says how long it is.
            None => match error.kind() {
                ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => {
                    Self::Closed
                }
                _ => Self::Io(error),
            },
        }
    }
}

/// Bytes that went through, for statistics.
#[derive(Clone, Debug, Default)]
pub struct ByteCount(Arc<Count>);

#[derive(Debug, Default)]
struct Count {
    bytes: AtomicU64,
    /// What counts the same bytes, among others.
    total: Option<ByteCount>,
}

impl ByteCount {
    /// The count so far.
    #[must_use]
    pub fn get(&self) -> u64 {
        self.0.bytes.load(Ordering::Relaxed)
    }

    /// A count from zero, which `total` takes part in.
    #[must_use]
    pub fn within(total: &Self) -> Self {
        Self(Arc::new(Count {
            bytes: AtomicU64::new(0),
            total: Some(total.clone()),
        }))
    }

    fn add(&self, bytes: usize) {
        self.0.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
        if let Some(total) = &self.0.total {
            total.add(bytes);
        }
    }
}

/// The receiving half.
#[derive(Debug)]
pub struct Receiver<R> {
    stream: R,
    decoder: Decoder,
    heard: Instant,
    dead_after: Duration,
    count: ByteCount,
}

impl<R: AsyncRead + Unpin> Receiver<R> {
    /// Listens to a stream.
    pub fn new(stream: R) -> Self {
        Self {
            stream,
            decoder: Decoder::default(),
            heard: Instant::now(),
            dead_after: DEAD_AFTER,
            count: ByteCount::default(),
        }
    }

    /// Bytes received.
    #[must_use]
    pub fn count(&self) -> ByteCount {
        self.count.clone()
    }

    /// Counts into `total` from now on, which others may count into as well.
    pub fn count_into(&mut self, total: &ByteCount) {
        self.count = total.clone();
    }

    /// The protocol version of the peer, once it has said something.
    #[must_use]
    pub fn peer_version(&self) -> Option<u16> {
        self.decoder.peer_version()
    }

    /// The next message. May be dropped while it waits, without loss.
    ///
    /// # Errors
    /// [`LinkError`]; the connection is then of no more use.
    pub async fn receive<M: Message>(&mut self) -> Result<M, LinkError> {
        loop {
            if let Some(message) = self.decoder.next()? {
                return Ok(message);
            }
            let deadline = self.heard + self.dead_after;
            let room = self.decoder.room(PIECE);
            let bytes = timeout_at(deadline, self.stream.read_buf(room))
                .await
                .map_err(|_| LinkError::Silent(self.dead_after))??;
            if bytes == 0 {
                return Err(LinkError::Closed);
            }
            self.heard = Instant::now();
            self.count.add(bytes);
        }
    }
}

/// The sending half.
#[derive(Debug)]
pub struct Sender<W> {
    stream: W,
    bytes: Vec<u8>,
    count: ByteCount,
}

impl<W: AsyncWrite + Unpin> Sender<W> {
    /// Talks into a stream.
    pub fn new(stream: W) -> Self {
        Self {
            stream,
            bytes: Vec::new(),
            count: ByteCount::default(),
        }
    }

    /// Bytes sent.
    #[must_use]
    pub fn count(&self) -> ByteCount {
        self.count.clone()
    }

    /// Counts into `total` from now on, which others may count into as well.
    pub fn count_into(&mut self, total: &ByteCount) {
        self.count = total.clone();
    }

    /// Sends a message and waits until the stream has taken it. If this is dropped while it
    /// waits, the connection is of no more use.
    ///
    /// # Errors
    /// [`LinkError`]; [`LinkError::Stuck`] if the peer does not take a single byte for
    /// [`DEAD_AFTER`].
    pub async fn send<M: Message>(&mut self, message: &M) -> Result<(), LinkError> {
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        encode(message, &mut bytes)?;
        let sent = self.send_encoded(&bytes).await;
        self.bytes = bytes;
        sent
    }

    /// Sends a message, or several, that were encoded before; see [`Self::send`].
    ///
    /// # Errors
    /// [`LinkError`], as [`Self::send`].
    pub async fn send_encoded(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let piece = &rest[..rest.len().min(PIECE)];
            let taken = timeout(DEAD_AFTER, self.stream.write(piece))
                .await
                .map_err(|_| LinkError::Stuck(DEAD_AFTER))??;
            if taken == 0 {
                return Err(LinkError::Closed);
            }
            rest = &rest[taken..];
        }
        // TLS may hold back some records, and those are few.
        timeout(DEAD_AFTER, self.stream.flush())
            .await
            .map_err(|_| LinkError::Stuck(DEAD_AFTER))??;
        self.count.add(bytes.len());
        Ok(())
    }
}

/// A stream as its two halves.
pub fn split<S: AsyncRead + AsyncWrite>(
    stream: S,
) -> (
    Receiver<tokio::io::ReadHalf<S>>,
    Sender<tokio::io::WriteHalf<S>>,
) {
    let (read, write) = tokio::io::split(stream);
    (Receiver::new(read), Sender::new(write))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lie_protocol::{ClientToShader, Ping};

    #[tokio::test(start_paused = true)]
    async fn silence_is_death_but_a_trickle_is_life() {
        let (near, far) = tokio::io::duplex(64);
        let (mut receiver, _keep) = split(near);
        let (_far_receiver, mut far) = tokio::io::split(far);
        let mut bytes = Vec::new();
        encode(&ClientToShader::Ping(Ping { nonce: 1 }), &mut bytes).unwrap();
        let trickle = tokio::spawn(async move {
            for byte in bytes {
                tokio::time::sleep(Duration::from_secs(4)).await;
                far.write_all(&[byte]).await.unwrap();
            }
            far
        });
        let message: ClientToShader = receiver.receive().await.unwrap();
        assert_eq!(message, ClientToShader::Ping(Ping { nonce: 1 }));
        let _far = trickle.await.unwrap();
        let silent = receiver.receive::<ClientToShader>().await;
        assert!(matches!(silent, Err(LinkError::Silent(_))), "{silent:?}");
    }

    #[test]
    fn what_is_counted_for_one_is_counted_for_all() {
        let total = ByteCount::default();
        let (one, other) = (ByteCount::within(&total), ByteCount::within(&total));
        one.add(3);
        other.add(4);
        assert_eq!((one.get(), other.get(), total.get()), (3, 4, 7));
    }

    #[tokio::test(start_paused = true)]
    async fn a_peer_that_takes_nothing_is_given_up() {
        let (near, _far) = tokio::io::duplex(4);
        let (_receiver, mut sender) = split(near);
        let stuck = sender.send(&ClientToShader::Ping(Ping { nonce: 1 })).await;
        assert!(matches!(stuck, Err(LinkError::Stuck(_))), "{stuck:?}");
    }
}
