//! Messages of every direction: framing, decoding, and what a process then does with them.

mod receive;
mod seeds;
mod way;

use lie_protocol::{Decoder, Header, Message, ProtocolError, encode};

pub use way::Way;

use crate::{Form, Memory, Target};
use receive::Processes;

/// Input: a byte that says who talks to whom, then what goes through the connection.
pub(crate) const TARGET: Target = Target {
    name: "messages",
    seeds: || {
        let all = seeds::all();
        all.iter().map(|(way, bytes)| input(*way, bytes)).collect()
    },
    open: || {
        let mut processes = Processes::new();
        Box::new(move |bytes| run(&mut processes, bytes))
    },
    memory: Memory {
        fixed: 1 << 20,
        for_each: 512,
    },
    form: Form::Bytes,
};

/// In the first byte: the length in the first header is put right before anything is read, so
/// that what was inserted or cut out gets past it.
const MENDED: u8 = 0x80;

fn input(way: Way, bytes: &[u8]) -> Vec<u8> {
    let mut input = vec![way as u8 | MENDED];
    input.extend_from_slice(bytes);
    input
}

fn run(processes: &mut Processes, input: &[u8]) -> bool {
    let Some((&first, bytes)) = input.split_first() else {
        return false;
    };
    let mut bytes = bytes.to_vec();
    if first & MENDED != 0
        && let Some(body) = bytes.len().checked_sub(Header::LENGTH)
    {
        bytes[8..Header::LENGTH].copy_from_slice(&(body as u32).to_le_bytes());
    }
    let way = Way::ALL[usize::from(first & !MENDED) % Way::ALL.len()];
    way.read(processes, &bytes)
}

/// Reads what comes in one direction, up to the first error, and hands on what is whole. Says
/// whether anything was.
fn read<M: Message + Clone>(bytes: &[u8], mut receive: impl FnMut(M)) -> bool {
    let mut is_taken = false;
    let mut decoder = Decoder::default();
    // As a socket gives it: neither message by message nor all at once.
    for piece in bytes.chunks(1400) {
        decoder.push(piece);
        loop {
            match decoder.next::<M>() {
                Ok(Some(message)) => {
                    goes_round(&message);
                    receive(message);
                    is_taken = true;
                }
                Ok(None) => break,
                Err(error) => {
                    check_error(&error);
                    return is_taken;
                }
            }
        }
        assert!(decoder.pending() <= bytes.len());
    }
    is_taken
}

/// What was read can be sent on, and is then read as the same.
fn goes_round<M: Message>(message: &M) {
    let (mut once, mut twice) = (Vec::new(), Vec::new());
    encode(message, &mut once).unwrap();
    let mut decoder = Decoder::default();
    decoder.push(&once);
    let again: M = decoder.next().unwrap().unwrap();
    encode(&again, &mut twice).unwrap();
    // Bytes, since NaN is not equal to itself.
    assert!(once == twice);
}

fn check_error(error: &ProtocolError) {
    let message = error.to_string();
    assert!(
        message.len() < 1000,
        "fit for a log: {} bytes",
        message.len()
    );
}
