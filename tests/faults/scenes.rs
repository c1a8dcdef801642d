//! A constructor that comes back with another scene.

use std::time::Duration;

use lie_farm::{
    client::{Client, ClientConfig, ClientError},
    network::Exposure,
};
use tokio::time::sleep;

use crate::{
    rig::walk,
    support::{Process, cornell, patience::patiently, wait_until},
};

async fn connect(address: &str) -> Client {
    let client = Client::connect(ClientConfig::new(address, Exposure::Loopback))
        .await
        .unwrap();
    client.wait_for_shaders(1).await;
    client
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn another_scene_is_noticed_and_told_by_all() {
    let home = tempfile::tempdir().unwrap();
    let other = home.path().join("other.toml");
    let text = std::fs::read_to_string(cornell().join("scene.toml")).unwrap();
    std::fs::write(
        &other,
        text.replace("name = \"cornell\"", "name = \"elsewhere\""),
    )
    .unwrap();

    let mut constructor = Process::constructor(&[]);
    let address = constructor.address.clone();
    let shader = Process::shader(&address);
    let mut client = connect(&address).await;
    let request = walk(&client).remove(0);
    client.render_frame(&request).await.unwrap();
    constructor.kill();
    let other = other.to_str().unwrap();
    let arguments = ["constructor", other, "--threads", "1", "--listen", &address];
    let mut constructor = Process::start(&arguments);

    // Pictures go on until the shader has the new scene; then it is said why there are none.
    let ended = patiently(async {
        loop {
            if let Err(error) = client.render_frame(&request).await {
                return error;
            }
            sleep(Duration::from_millis(20)).await;
        }
    });
    let error = ended.await.expect("the client notices");
    assert!(matches!(error, ClientError::OtherScene { .. }), "{error}");
    assert!(error.to_string().contains("'elsewhere'") && error.to_string().contains(&address));
    assert_eq!(client.other_scene().unwrap().as_str(), "elsewhere");
    let log = shader.log();
    assert!(
        log.contains("the constructor holds another scene now"),
        "{log}"
    );

    // Who comes now gets the new scene.
    let mut newcomer = connect(&address).await;
    assert_eq!(newcomer.scene().name.as_str(), "elsewhere");
    newcomer.render_frame(&request).await.unwrap();

    // With the old scene back, the old client goes on.
    constructor.kill();
    let _constructor = Process::constructor(&["--listen", &address]);
    wait_until("the scene is ours again", || client.other_scene().is_none());
    let frame = patiently(client.render_frame(&request)).await;
    frame.expect("a frame hangs").unwrap();
    assert!(newcomer.render_frame(&request).await.is_err());
}
