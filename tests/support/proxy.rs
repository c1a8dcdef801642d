//! A way between two processes that can be slow, silent or cut.

use std::{
    net::{IpAddr, SocketAddr},
    sync::mpsc,
    thread,
    time::Duration,
};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{
        TcpListener, TcpSocket, TcpStream,
        tcp::{OwnedReadHalf, OwnedWriteHalf},
    },
    sync::watch,
    time::sleep,
};

/// What becomes of the bytes on their way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Weather {
    /// They pass.
    Fair,
    /// So many pass in a second, in each direction of each connection, and every piece is late.
    Slow { bytes_per_s: f64, delay: Duration },
    /// None passes, and nobody is told.
    Silent,
    /// Connections are closed, and new ones as well.
    Cut,
}

/// Passes connections on, from a thread of its own, until it is dropped.
pub(crate) struct Proxy {
    pub(crate) address: SocketAddr,
    weather: watch::Sender<Weather>,
}

impl Proxy {
    /// Takes connections at `listen` and makes each anew, coming from `from`, to `to`.
    pub(crate) fn start(listen: SocketAddr, from: IpAddr, to: SocketAddr) -> Self {
        let (weather, forecast) = watch::channel(Weather::Fair);
        let (said, heard) = mpsc::channel();
        thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_all()
                .build();
            runtime.expect("a runtime").block_on(async {
                let listener = TcpListener::bind(listen).await.expect("a free port");
                said.send(listener.local_addr().expect("an address"))
                    .expect("somebody listens");
                pass_on(listener, from, to, forecast).await;
            });
        });
        Self {
            address: heard.recv().expect("the proxy listens"),
            weather,
        }
    }

    /// From now on.
    pub(crate) fn set(&self, weather: Weather) {
        self.weather.send_replace(weather);
    }
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

/// One connection; closed at both ends when it ends at one.
async fn carry(
    near: TcpStream,
    from: IpAddr,
    to: SocketAddr,
    mut forecast: watch::Receiver<Weather>,
) {
    if *forecast.borrow() == Weather::Cut {
        return;
    }
    let socket = TcpSocket::new_v4().expect("a socket");
    socket.bind((from, 0).into()).expect("an address of ours");
    let Ok(far) = socket.connect(to).await else {
        return;
    };
    for stream in [&near, &far] {
        stream.set_nodelay(true).expect("a socket");
    }
    let ((near_in, near_out), (far_in, far_out)) = (near.into_split(), far.into_split());
    let (there, back) = (forecast.clone(), forecast.clone());
    tokio::select! {
        () = pump(near_in, far_out, there) => {}
        () = pump(far_in, near_out, back) => {}
        _ = forecast.wait_for(|weather| *weather == Weather::Cut) => {}
    }
}

async fn pump(
    mut from: OwnedReadHalf,
    mut to: OwnedWriteHalf,
    mut forecast: watch::Receiver<Weather>,
) {
    let mut piece = vec![0; 4096];
    while let Ok(count @ 1..) = from.read(&mut piece).await {
        let passes = forecast
            .wait_for(|weather| *weather != Weather::Silent)
            .await;
        let Ok(weather) = passes.map(|weather| *weather) else {
            return;
        };
        if let Weather::Slow { bytes_per_s, delay } = weather {
            sleep(delay + Duration::from_secs_f64(count as f64 / bytes_per_s)).await;
        }
        if to.write_all(&piece[..count]).await.is_err() {
            return;
        }
    }
}
