//! The messages that take the most memory for each of their bytes, as long as they may be.

use lie_protocol::{
    ConstructorToShader, Decoder, LieDelta, Message, WireBody, WireCell, WireLight, encode, limit,
};
use lie_trial::Way;

use crate::{
    MEMORY,
    drive::{most_memory, target, turn},
};

/// What decoding a message takes at most, for each byte of it.
const DECODED: usize = 64;

fn cell(key: u64, body: WireBody) -> WireCell {
    let version = 0;
    WireCell { key, version, body }
}

fn leaf(lights: Vec<WireLight>, hidden: Vec<u32>) -> WireBody {
    WireBody::Leaf {
        region: None,
        lights,
        hidden,
        crowded: vec![],
    }
}

fn update(cells: Vec<WireCell>) -> Vec<u8> {
    let delta = LieDelta {
        from_version: 0,
        to_version: 1,
        part: 0,
        last: true,
        cells,
    };
    let mut bytes = Vec::new();
    encode(&ConstructorToShader::LieDelta(delta), &mut bytes).unwrap();
    bytes
}

/// Lists of the smallest elements, as many as there may be.
fn dense() -> [Vec<u8>; 4] {
    let interior = cell(1, WireBody::Interior);
    let light = WireLight {
        light: 0,
        occluders: vec![],
    };
    let occluded = WireLight {
        light: 0,
        occluders: vec![0; limit::OCCLUDERS],
    };
    [
        update(vec![interior; limit::CELLS]),
        update(vec![cell(1, leaf(vec![light; limit::LIGHTS], vec![]))]),
        update(vec![cell(1, leaf(vec![], vec![0; limit::LIGHTS]))]),
        update(vec![cell(1, leaf(vec![occluded; 3], vec![]))]),
    ]
}

fn decode<M: Message>(bytes: &[u8]) -> M {
    let mut decoder = Decoder::default();
    decoder.push(bytes);
    decoder.next().unwrap().unwrap()
}

#[test]
fn the_densest_messages_take_no_more_than_is_said() {
    let _turn = turn();
    for bytes in dense() {
        let run = || drop(decode::<ConstructorToShader>(&bytes));
        let most = most_memory(run);
        let each = most.div_ceil(bytes.len());
        println!("{} bytes: {each} for each", bytes.len());
        assert!(each <= DECODED, "{each}");
    }
}

/// Cells of the deepest level, each in a place of its own, split all that is above them.
#[test]
fn the_deepest_cells_take_no_more_than_is_said() {
    let _turn = turn();
    let depth = 20;
    let spread = |index: u64| index.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - 3 * depth);
    let key = |index| (1 << (3 * depth)) | spread(index);
    let cells = (0..20_000).map(|index| cell(key(index), leaf(vec![], vec![])));
    let mut input = vec![Way::ConstructorToShader as u8];
    input.extend(update(cells.collect()));
    let messages = target("messages");
    let mut run = (messages.open)();
    let most = most_memory(|| assert!(run(&input)));
    println!(
        "{} bytes: {} for each",
        input.len(),
        most.div_ceil(input.len())
    );
    assert!(most <= messages.memory.of(input.len()));
    assert!(MEMORY.current_usage() < most, "nothing of it stays");
}
