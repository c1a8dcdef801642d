//! As much of HTTP as it takes to be scraped: one GET on each connection, and nothing of what is
//! sent decides anything but which of a few fixed answers there is.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    net::{TcpListener, TcpStream},
    task::JoinSet,
    time::{sleep, timeout},
};

use crate::serve::{Lobby, Place};

/// How long a connection may take from its beginning to the end of the answer.
const DEADLINE: Duration = Duration::from_secs(5);
/// Longest request, to the end of its head; what follows is not read.
const MAX_HEAD: usize = 8 * 1024;
/// Pause after the system refused to accept.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);
/// How long a peer may take to hear the end.
const LAST_WORD: Duration = Duration::from_millis(500);

/// The format's name.
const CONTENT_TYPE: &str = "text/plain; version=0.0.4; charset=utf-8";

/// Answers for as long as this is polled; `metrics` writes what there is to say. Without a listener
/// there is nothing to do.
///
/// Connections are limited as those of strangers are: of an address that has too many, the oldest
/// goes. So one that says nothing keeps nobody out.
pub(crate) async fn serve(
    listener: Option<TcpListener>,
    metrics: impl Fn() -> String + Clone + Send + 'static,
) -> std::convert::Infallible {
    let Some(listener) = listener else {
        return std::future::pending().await;
    };
    if let Ok(address) = listener.local_addr() {
        tracing::info!("metrics are at http://{address}/metrics");
    }
    let lobby = Lobby::default();
    let mut connections = JoinSet::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            Some(_) = connections.join_next() => continue,
        };
        match accepted {
            Ok((stream, peer)) => {
                let place = lobby.enter(peer.ip());
                connections.spawn(connection(stream, place, metrics.clone()));
            }
            Err(error) => {
                tracing::warn!("cannot take a connection for metrics: {error}");
                sleep(ACCEPT_PAUSE).await;
            }
        }
    }
}

async fn connection(mut stream: TcpStream, place: Place, metrics: impl Fn() -> String) {
    tokio::select! {
        // How it ends is the peer's business alone.
        _ = timeout(DEADLINE, answer(&mut stream, metrics)) => {}
        () = place.lost() => {}
    }
}

async fn answer<S: AsyncRead + AsyncWrite + Unpin>(
    stream: &mut S,
    metrics: impl Fn() -> String,
) -> io::Result<()> {
    let response = match read_head(stream).await? {
        Some(head) => respond(&head, metrics),
        None => Response::error("431 Request Header Fields Too Large"),
    };
    stream.write_all(response.to_bytes().as_slice()).await?;
    stream.shutdown().await?;
    // Closed at once, with bytes that nobody has read, a connection is reset and the answer lost.
    let rest = async {
        let mut ignored = [0; 1024];
        while stream.read(&mut ignored).await? > 0 {}
        Ok(())
    };
    timeout(LAST_WORD, rest).await.unwrap_or(Ok(()))
}

/// A request to the empty line after its head; `None` if that does not come soon enough.
async fn read_head<S: AsyncRead + Unpin>(stream: &mut S) -> io::Result<Option<Vec<u8>>> {
    let mut head = Vec::new();
    let mut piece = [0; 1024];
    loop {
        let count = stream.read(&mut piece).await?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        // An end may be cut in two.
        let from = head.len().saturating_sub(3);
        head.extend_from_slice(&piece[..count]);
        let fresh = &head[from..];
        let ends = |end: &[u8]| fresh.windows(end.len()).any(|bytes| bytes == end);
        if head.len() <= MAX_HEAD && (ends(b"\r\n\r\n") || ends(b"\n\n")) {
            return Ok(Some(head));
        }
        if head.len() > MAX_HEAD {
            return Ok(None);
        }
    }
}

/// What is answered.
#[derive(Debug, PartialEq)]
struct Response {
    status: &'static str,
    body: String,
    /// The body is described and not sent.
    is_head: bool,
}

/// What a request gets. Of its head only the first line counts.
fn respond(head: &[u8], metrics: impl Fn() -> String) -> Response {
    let line = head.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let line = std::str::from_utf8(line).unwrap_or_default();
    let mut words = line.trim_end_matches('\r').split(' ');
    let (Some(method), Some(target), Some(version), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return Response::error("400 Bad Request");
    };
    if !version.starts_with("HTTP/1.") {
        return Response::error("400 Bad Request");
    }
    let is_head = method == "HEAD";
    if !is_head && method != "GET" {
        return Response::error("405 Method Not Allowed");
    }
    if target.split('?').next() != Some("/metrics") {
        return Response {
            is_head,
            ..Response::error("404 Not Found")
        };
    }
    Response {
        status: "200 OK",
        body: metrics(),
        is_head,
    }
}

impl Response {
    fn error(status: &'static str) -> Self {
        Self {
            status,
            body: format!("{status}; metrics are at /metrics\n"),
            is_head: false,
        }
    }

    fn to_bytes(&self) -> Vec<u8> {
        let Self { status, body, .. } = self;
        let mut text = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {CONTENT_TYPE}\r\nContent-Length: {}\r\n\
             Allow: GET, HEAD\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n",
            body.len()
        );
        if !self.is_head {
            text += body;
        }
        text.into_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_get_of_the_metrics_gets_them() {
        for (request, status) in [
            ("GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n", "200"),
            ("GET /metrics?a=b HTTP/1.0\n\n", "200"),
            ("HEAD /metrics HTTP/1.1\r\n\r\n", "200"),
            ("GET / HTTP/1.1\r\n\r\n", "404"),
            ("GET /metrics/../etc HTTP/1.1\r\n\r\n", "404"),
            ("GET http://a/metrics HTTP/1.1\r\n\r\n", "404"),
            ("POST /metrics HTTP/1.1\r\n\r\n", "405"),
            ("GET /metrics HTTP/2\r\n\r\n", "400"),
            ("GET  /metrics HTTP/1.1\r\n\r\n", "400"),
            ("GET /metrics\r\n\r\n", "400"),
            ("\r\n\r\n", "400"),
            ("LIE\x1a\0\0\n\n", "400"),
        ] {
            let response = respond(request.as_bytes(), || "numbers".to_owned());
            assert!(response.status.starts_with(status), "{request}");
            assert_eq!(response.body == "numbers", status == "200", "{request}");
        }
        let garbage = respond(&[0xff, 0xfe, b'\n', b'\n'], String::new);
        assert_eq!(garbage.status, "400 Bad Request");
    }

    #[test]
    fn a_head_is_sent_without_its_body() {
        let response = respond(b"HEAD /metrics HTTP/1.1\r\n\r\n", || "four".to_owned());
        let text = String::from_utf8(response.to_bytes()).unwrap();
        assert!(text.contains("Content-Length: 4\r\n"), "{text}");
        assert!(text.ends_with("\r\n\r\n"), "{text}");
    }

    /// What a peer that sends these pieces is answered.
    async fn exchange(pieces: &[&[u8]]) -> String {
        let (mut near, mut far) = tokio::io::duplex(16 * 1024);
        let answering = async {
            let result = answer(&mut near, || "numbers".to_owned()).await;
            drop(near);
            result
        };
        let asking = async {
            for piece in pieces {
                far.write_all(piece).await.unwrap();
                tokio::task::yield_now().await;
            }
            let mut text = String::new();
            far.read_to_string(&mut text).await.unwrap();
            text
        };
        tokio::join!(answering, asking).1
    }

    #[tokio::test]
    async fn a_head_may_come_in_pieces_but_not_for_ever() {
        let cut: [&[u8]; 4] = [b"GET /metr", b"ics HTTP/1.1\r\n\r", b"", b"\n"];
        assert!(exchange(&cut).await.ends_with("numbers"));
        let endless = vec![b'a'; MAX_HEAD + 1];
        let answer = exchange(&[b"GET /metrics HTTP/1.1\r\nX: ", &endless]).await;
        assert!(answer.starts_with("HTTP/1.1 431 "), "{answer}");
    }
}
