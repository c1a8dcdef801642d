//! Scenes as they travel to shaders.

use lie_farm::scene_blob::{decode, encode};
use lie_scene::{Rooms, Summary, cornell_box, rooms};

use crate::{Form, Memory, Target, scenes};

pub(crate) const TARGET: Target = Target {
    name: "scene_blob",
    seeds,
    open: || Box::new(run),
    memory: Memory {
        fixed: 2 << 20,
        for_each: 64,
    },
    form: Form::Bytes,
};

fn seeds() -> Vec<Vec<u8>> {
    let small = rooms(&Rooms {
        rooms: 1,
        lights_in_each: 3,
    });
    let scenes = [scenes::of_every_kind(), cornell_box(), small];
    scenes.iter().map(|scene| encode(scene).unwrap()).collect()
}

fn run(bytes: &[u8]) -> bool {
    let Ok(scene) = decode(bytes) else {
        return false;
    };
    assert_eq!(scene.validate(), Ok(()));
    let _ = Summary::new(&scene).to_string();
    // Another process that gets it from us must understand it, and us.
    let again = encode(&scene).unwrap();
    let bytes = encode(&decode(&again).unwrap()).unwrap();
    assert!(bytes == again);
    true
}
