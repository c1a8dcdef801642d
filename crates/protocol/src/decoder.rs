use crate::{Header, Message, PROTOCOL_VERSION, ProtocolError};

/// Appends a message as one frame.
///
/// # Errors
/// [`ProtocolError::TooLong`] if the body is over its kind's limit; `out` is then as before.
pub fn encode<M: Message>(message: &M, out: &mut Vec<u8>) -> Result<(), ProtocolError> {
    let (start, kind) = (out.len(), message.kind());
    out.extend_from_slice(&[0; Header::LENGTH]);
    let written = message.write_body(out).and_then(|()| {
        let length = (out.len() - start - Header::LENGTH) as u64;
        check_length::<M>(kind, length)
    });
    match written {
        Ok(length) => {
            let header = Header {
                version: PROTOCOL_VERSION,
                kind,
                length,
            };
            out[start..start + Header::LENGTH].copy_from_slice(&header.to_bytes());
            Ok(())
        }
        Err(error) => {
            out.truncate(start);
            Err(error)
        }
    }
}

/// Turns bytes, as they come, into messages.
///
/// Holds at most one unfinished frame and whatever was pushed since the last call of
/// [`Self::next`] that returned `None`. After an error the stream has lost its place: drop
/// the connection.
#[derive(Debug, Default)]
pub struct Decoder {
    bytes: Vec<u8>,
    /// Everything before this has been read.
    start: usize,
    peer_version: Option<u16>,
}

impl Decoder {
    /// Adds bytes that have arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        self.room(bytes.len()).extend_from_slice(bytes);
    }

    /// Where bytes that arrive are appended without another copy; there is room for at least
    /// so many. What is in it waits for the rest of its frame.
    pub fn room(&mut self, bytes: usize) -> &mut Vec<u8> {
        if self.start > 0 {
            self.bytes.drain(..self.start);
            self.start = 0;
        }
        self.bytes.reserve(bytes);
        &mut self.bytes
    }

    /// The next whole message; `None` if it has not arrived in full. Which messages may
    /// come is the caller's choice at each call.
    ///
    /// # Errors
    /// [`ProtocolError`], as soon as the header shows it: a body that is refused is not
    /// waited for.
    #[expect(clippy::should_implement_trait, reason = "generic over the message")]
    pub fn next<M: Message>(&mut self) -> Result<Option<M>, ProtocolError> {
        let pending = &self.bytes[self.start..];
        let Some((header, rest)) = pending.split_first_chunk::<{ Header::LENGTH }>() else {
            // What is not ours is known by its first bytes; there may never be more.
            return pending
                .first_chunk()
                .map_or(Ok(()), |first| Header::check_magic(*first))
                .map(|()| None);
        };
        let header = Header::from_bytes(*header)?;
        self.peer_version = Some(header.version);
        if header.version != PROTOCOL_VERSION && !M::is_timeless(header.kind) {
            return Err(ProtocolError::Version {
                theirs: header.version,
            });
        }
        let length = check_length::<M>(header.kind, u64::from(header.length))? as usize;
        let Some(body) = rest.get(..length) else {
            return Ok(None);
        };
        let message = M::read_body(header.kind, body)?;
        self.start += Header::LENGTH + length;
        Ok(Some(message))
    }

    /// The protocol version in the header that came last.
    #[must_use]
    pub fn peer_version(&self) -> Option<u16> {
        self.peer_version
    }

    /// Bytes that wait for the rest of their frame.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.bytes.len() - self.start
    }
}

fn check_length<M: Message>(kind: u16, length: u64) -> Result<u32, ProtocolError> {
    let max = M::max_length(kind).ok_or(ProtocolError::Kind(kind))?;
    match u32::try_from(length) {
        Ok(length) if length <= max => Ok(length),
        _ => Err(ProtocolError::TooLong { kind, length, max }),
    }
}
