use std::sync::Arc;

use lie_protocol::{
    ConstructorToShader as In, SceneRequest, ShaderToConstructor as Out, ShaderWelcome, limit,
};
use lie_render::World;
use tokio::{io::AsyncRead, sync::mpsc, task::spawn_blocking};

use super::{ShaderConfig, answers};
use crate::{
    cache::SceneCache,
    connection::{LinkError, Receiver},
    scene_blob::{decode, hash_of},
};

/// The world of a welcome: from the cache, or from the constructor and then into the cache.
pub(super) async fn world<R: AsyncRead + Unpin>(
    config: &ShaderConfig,
    welcome: &ShaderWelcome,
    receiver: &mut Receiver<R>,
    outbox: &mpsc::Sender<Out>,
) -> Result<Arc<World>, LinkError> {
    let hash = welcome.scene;
    let (cache, accel) = (&config.cache, config.accel);
    let cached = match cache.clone() {
        Some(cache) => blocking(move || cache.load(hash)).await?,
        None => None,
    };
    let bytes = match cached {
        Some(bytes) => {
            tracing::info!("the scene comes from the cache ({} bytes)", bytes.len());
            bytes
        }
        None => {
            let bytes = fetch(welcome, receiver, outbox).await?;
            tracing::info!("the scene came over the network ({} bytes)", bytes.len());
            keep(cache.clone(), bytes, welcome).await?
        }
    };
    let built = blocking(move || {
        decode(&bytes).map(|scene| {
            drop(bytes);
            Arc::new(World::with_accel(Arc::new(scene), accel))
        })
    })
    .await?;
    built.map_err(|error| LinkError::Rules(error.to_string()))
}

/// Asks for the scene and puts its chunks together. The memory grows with what arrives, not
/// with what is promised.
async fn fetch<R: AsyncRead + Unpin>(
    welcome: &ShaderWelcome,
    receiver: &mut Receiver<R>,
    outbox: &mpsc::Sender<Out>,
) -> Result<Vec<u8>, LinkError> {
    if welcome.scene_length > limit::SCENE {
        return Err(LinkError::Rules("the scene is too long".to_owned()));
    }
    let request = SceneRequest {
        scene: welcome.scene,
        offset: 0,
    };
    answers::post(outbox, Out::SceneRequest(request))?;
    let mut bytes = Vec::new();
    loop {
        match receiver.receive().await? {
            In::SceneChunk(chunk) => {
                let end = (bytes.len() + chunk.bytes.len()) as u64;
                if chunk.offset != bytes.len() as u64 || end > welcome.scene_length {
                    return Err(LinkError::Rules(
                        "a chunk of the scene is misplaced".to_owned(),
                    ));
                }
                bytes.extend_from_slice(&chunk.bytes);
            }
            In::SceneReady(_) if bytes.len() as u64 == welcome.scene_length => return Ok(bytes),
            In::SceneReady(_) => {
                return Err(LinkError::Rules("the scene ended too early".to_owned()));
            }
            other => answers::answer(other, outbox)?,
        }
    }
}

/// Checks the hash and stores the bytes; a cache that fails is only a pity.
async fn keep(
    cache: Option<SceneCache>,
    bytes: Vec<u8>,
    welcome: &ShaderWelcome,
) -> Result<Vec<u8>, LinkError> {
    let hash = welcome.scene;
    let (bytes, whole) = blocking(move || {
        let whole = hash_of(&bytes) == hash;
        if let Some(cache) = cache.filter(|_| whole)
            && let Err(error) = cache.store(hash, &bytes)
        {
            tracing::warn!(
                "the scene is not cached, {}: {error}",
                cache.path(hash).display()
            );
        }
        (bytes, whole)
    })
    .await?;
    if whole {
        Ok(bytes)
    } else {
        Err(LinkError::Rules(
            "the scene's bytes do not have its hash".to_owned(),
        ))
    }
}

async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, LinkError> {
    spawn_blocking(work)
        .await
        .map_err(|_| LinkError::Rules("the scene could not be worked on".to_owned()))
}
