//! Several clients at once on one scene.

use crate::{
    rig::{Rig, walk},
    support::patience::patiently,
};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn clients_beside_each_other_get_their_own_frames() {
    let rig = Rig::start(2, false);
    let mut alone = rig.client().await;
    let requests = walk(&alone);
    let mut films = Vec::new();
    for request in &requests {
        films.push(alone.render_frame(request).await.unwrap().film);
    }
    drop(alone);
    let each = (0..4).map(|start: usize| {
        let (rig, requests, films) = (&rig, &requests, &films);
        async move {
            let mut client = rig.client().await;
            // Each is elsewhere on the walk, and one goes backwards.
            for step in 0..3 * requests.len() {
                let step = if start == 3 {
                    3 * requests.len() - step
                } else {
                    step
                };
                let view = (start + step) % requests.len();
                let mut request = requests[view].clone();
                // And one wants other random numbers.
                if start == 2 {
                    request.seed = 5;
                }
                let frame = patiently(client.render_frame(&request)).await;
                let film = frame.expect("a frame hangs").unwrap().film;
                assert_eq!(
                    film == films[view],
                    start != 2,
                    "client {start}, view {view}"
                );
            }
        }
    });
    let [one, two, three, four] = <[_; 4]>::try_from(each.collect::<Vec<_>>()).ok().unwrap();
    tokio::join!(one, two, three, four);
}
