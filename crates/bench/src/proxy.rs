//! A way between two processes that can be late, slow, silent or cut.

use std::{
    io,
    net::{IpAddr, SocketAddr},
    sync::mpsc as threads,
    thread,
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{
        TcpListener, TcpSocket, TcpStream,
        tcp::{OwnedReadHalf, OwnedWriteHalf},
    },
    sync::{mpsc, watch},
    time::{Instant, sleep, sleep_until},
};

/// What becomes of the bytes on their way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weather {
    /// They pass.
    Fair,
    /// They pass, each so much later, however many there are.
    Late {
        /// In each direction.
        delay: Duration,
    },
    /// So many pass in a second, in each direction of each connection, and every piece is late.
    Slow {
        /// In each direction.
        bytes_per_s: f64,
        /// Of each piece after the other.
        delay: Duration,
    },
    /// None passes, and nobody is told.
    Silent,
    /// Connections are closed, and new ones as well.
    Cut,
}

/// Most bytes of a piece.
const PIECE: usize = 4096;

/// Pieces that may be on their way in one direction of a connection.
const ON_THE_WAY: usize = 256;

/// Passes connections on, from a thread of its own, until it is dropped.
pub struct Proxy {
    address: SocketAddr,
    weather: watch::Sender<Weather>,
}

impl Proxy {
    /// Takes connections at `listen` and makes each anew, coming from `from`, to `to`.
    ///
    /// # Errors
    /// If it cannot listen there.
    pub fn start(listen: SocketAddr, from: IpAddr, to: SocketAddr) -> io::Result<Self> {
        let (weather, forecast) = watch::channel(Weather::Fair);
        let (said, heard) = threads::channel();
        thread::Builder::new()
            .name("proxy".to_owned())
            .spawn(move || {
                // Who started it has gone if nobody listens.
                let _ = match listen_at(listen) {
                    Ok((runtime, listener, address)) => {
                        let told = said.send(Ok(address));
                        runtime.block_on(pass_on(listener, from, to, forecast));
                        told
                    }
                    Err(error) => said.send(Err(error)),
                };
            })?;
        let ended = |_| Err(io::Error::other("the proxy has ended"));
        let address = heard.recv().unwrap_or_else(ended)?;
        Ok(Self { address, weather })
    }

    /// Where it takes connections.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// From now on.
    pub fn set(&self, weather: Weather) {
        self.weather.send_replace(weather);
    }
}

fn listen_at(
    address: SocketAddr,
) -> io::Result<(tokio::runtime::Runtime, TcpListener, SocketAddr)> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    let listener = runtime.block_on(TcpListener::bind(address))?;
    let address = listener.local_addr()?;
    Ok((runtime, listener, address))
}

/// Ends when the other end of the forecast is dropped, and with it all connections.
async fn pass_on(
    listener: TcpListener,
    from: IpAddr,
    to: SocketAddr,
    mut forecast: watch::Receiver<Weather>,
) {
    loop {
        tokio::select! {
            accepted = listener.accept() => if let Ok((near, _)) = accepted {
                tokio::spawn(carry(near, from, to, forecast.clone()));
            },
            changed = forecast.changed() => if changed.is_err() { return },
        }
    }
}

/// One connection; closed at both ends when it ends at one, or cannot be made.
async fn carry(
    near: TcpStream,
    from: IpAddr,
    to: SocketAddr,
    mut forecast: watch::Receiver<Weather>,
) {
    if *forecast.borrow() == Weather::Cut {
        return;
    }
    let Ok(far) = connect(from, to).await else {
        return;
    };
    for stream in [&near, &far] {
        if stream.set_nodelay(true).is_err() {
            return;
        }
    }
    let ((near_in, near_out), (far_in, far_out)) = (near.into_split(), far.into_split());
    let (there, back) = (forecast.clone(), forecast.clone());
    tokio::select! {
        () = pump(near_in, far_out, there) => {}
        () = pump(far_in, near_out, back) => {}
        _ = forecast.wait_for(|weather| *weather == Weather::Cut) => {}
    }
}

async fn connect(from: IpAddr, to: SocketAddr) -> io::Result<TcpStream> {
    let socket = TcpSocket::new_v4()?;
    socket.bind((from, 0).into())?;
    socket.connect(to).await
}

/// A piece on its way, and when it is to arrive.
type Piece = (Instant, Vec<u8>);

async fn pump(from: OwnedReadHalf, to: OwnedWriteHalf, forecast: watch::Receiver<Weather>) {
    let (sender, pieces) = mpsc::channel(ON_THE_WAY);
    let weather = forecast.clone();
    // What was taken in is given out before the end is passed on.
    let feed = async {
        take_in(from, sender, weather).await;
        std::future::pending::<()>().await;
    };
    tokio::select! {
        () = feed => {}
        () = give_out(pieces, to, forecast) => {}
    }
}

async fn take_in(
    mut from: OwnedReadHalf,
    pieces: mpsc::Sender<Piece>,
    forecast: watch::Receiver<Weather>,
) {
    let mut piece = vec![0; PIECE];
    while let Ok(count @ 1..) = from.read(&mut piece).await {
        let weather = *forecast.borrow();
        let delay = match weather {
            Weather::Late { delay } => delay,
            _ => Duration::ZERO,
        };
        let due = Instant::now() + delay;
        if pieces.send((due, piece[..count].to_vec())).await.is_err() {
            return;
        }
    }
}

async fn give_out(
    mut pieces: mpsc::Receiver<Piece>,
    mut to: OwnedWriteHalf,
    mut forecast: watch::Receiver<Weather>,
) {
    while let Some((due, piece)) = pieces.recv().await {
        if due > Instant::now() {
            sleep_until(due).await;
        }
        let passes = forecast
            .wait_for(|weather| *weather != Weather::Silent)
            .await;
        let Ok(weather) = passes.map(|weather| *weather) else {
            return;
        };
        if let Weather::Slow { bytes_per_s, delay } = weather {
            sleep(delay + Duration::from_secs_f64(piece.len() as f64 / bytes_per_s)).await;
        }
        if to.write_all(&piece).await.is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};

    use super::*;

    #[test]
    fn what_is_late_is_late_once_however_much_there_is() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let to = listener.local_addr().unwrap();
        let home = IpAddr::from([127, 0, 0, 1]);
        let proxy = Proxy::start((home, 0).into(), home, to).unwrap();
        let delay = Duration::from_millis(60);
        proxy.set(Weather::Late { delay });
        let mut near = std::net::TcpStream::connect(proxy.address()).unwrap();
        let (mut far, _) = listener.accept().unwrap();
        let bytes: Vec<u8> = (0..40 * PIECE).map(|at| at as u8).collect();
        let clock = std::time::Instant::now();
        near.write_all(&bytes).unwrap();
        let mut read = vec![0; bytes.len()];
        far.read_exact(&mut read).unwrap();
        let elapsed = clock.elapsed();
        assert!(read == bytes);
        assert!(elapsed >= delay, "{elapsed:?}");
        assert!(
            elapsed < 20 * delay,
            "{elapsed:?}: not each piece after the other"
        );
        drop(near);
        assert_eq!(
            far.read(&mut read).unwrap(),
            0,
            "the end is passed on as well"
        );
    }
}
