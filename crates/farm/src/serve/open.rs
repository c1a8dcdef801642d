//! From a connection that was accepted to a peer that has said who it is.

use std::time::Duration;

use lie_protocol::{Hello, MAGIC, Opening, Refuse, encode};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, ReadHalf, WriteHalf},
    net::TcpStream,
    time::timeout,
};

use crate::{
    connection::{self, LinkError, Receiver, Sender},
    handshake,
    network::Exposure,
    secure::{HandshakeFailure, Stream},
};

/// How long a peer that is refused may take to hear why.
const LAST_WORD: Duration = Duration::from_millis(500);
/// The first byte of a TLS handshake.
const TLS_HANDSHAKE: u8 = 0x16;
/// What TLS answers to what is not TLS: a record with a fatal alert.
const UNEXPECTED_MESSAGE: [u8; 7] = [0x15, 3, 3, 0, 2, 2, 10];

/// A peer that has said hello.
pub(crate) struct Caller {
    /// What it says of itself.
    pub(crate) hello: Hello,
    /// What comes from it.
    pub(crate) receiver: Receiver<ReadHalf<Stream>>,
    /// What goes to it.
    pub(crate) sender: Sender<WriteHalf<Stream>>,
}

/// A peer that is not let in.
pub(super) struct Rejected {
    /// Why.
    pub(super) error: LinkError,
    /// What is left of the connection, and what is to be said on it.
    rest: Option<(TcpStream, Vec<u8>)>,
}

/// Finds out what a peer speaks, secures the connection and waits for its hello.
pub(super) async fn open(stream: TcpStream, exposure: &Exposure) -> Result<Caller, Rejected> {
    let mut first = [0; MAGIC.len()];
    let count = stream.peek(&mut first).await?;
    let Some(&first_byte) = first[..count].first() else {
        return Err(LinkError::Closed.into());
    };
    let is_tls = first_byte == TLS_HANDSHAKE;
    let stream = match exposure {
        Exposure::Cluster(cluster) if is_tls => match cluster.accept(stream).await {
            Ok(stream) => stream,
            Err((error, rest)) => return Err(Rejected::after(error, rest)),
        },
        Exposure::Cluster(_) if MAGIC.starts_with(&first[..count]) => {
            return Err(Rejected::new(HandshakeFailure::Plaintext, stream));
        }
        Exposure::Cluster(_) => return Err(Rejected::new(HandshakeFailure::Garbage, stream)),
        _ if is_tls => return Err(Rejected::new(HandshakeFailure::UnexpectedTls, stream)),
        _ => Stream::Plain(stream),
    };
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::await_hello(&mut receiver, &mut sender).await?;
    Ok(Caller {
        hello,
        receiver,
        sender,
    })
}

impl Rejected {
    fn new(failure: HandshakeFailure, stream: TcpStream) -> Self {
        let mut word = Vec::new();
        match failure {
            // Whoever speaks TLS knows by whatever is not TLS.
            HandshakeFailure::UnexpectedTls => {
                let refusal = Refuse::new("this process has no bundle and takes no TLS");
                // It is far shorter than it may be; else there is no last word.
                let _ = encode(&Opening::Refuse(refusal), &mut word);
            }
            _ => word.extend(UNEXPECTED_MESSAGE),
        }
        Self {
            error: failure.into(),
            rest: Some((stream, word)),
        }
    }

    fn after(error: std::io::Error, rest: TcpStream) -> Self {
        let error = match LinkError::from(error) {
            LinkError::Handshake(HandshakeFailure::NotTls) => HandshakeFailure::Garbage.into(),
            error => error,
        };
        Self {
            error,
            rest: Some((rest, Vec::new())),
        }
    }

    /// Says the last word and waits until it was heard. Closed at once, with bytes that nobody
    /// has read, a connection is reset, and what was said last is lost on the way.
    pub(super) async fn see_off(self) {
        let Some((mut stream, word)) = self.rest else {
            return;
        };
        let leave = async {
            stream.write_all(&word).await?;
            stream.shutdown().await?;
            let mut ignored = [0; 1024];
            while stream.read(&mut ignored).await? > 0 {}
            Ok::<_, std::io::Error>(())
        };
        // Whether it hears is its own business.
        let _ = timeout(LAST_WORD, leave).await;
    }
}

impl From<LinkError> for Rejected {
    fn from(error: LinkError) -> Self {
        Self { error, rest: None }
    }
}

impl From<std::io::Error> for Rejected {
    fn from(error: std::io::Error) -> Self {
        LinkError::from(error).into()
    }
}
