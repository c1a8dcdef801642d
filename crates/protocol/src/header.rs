use crate::ProtocolError;

/// The first bytes of every frame.
pub const MAGIC: [u8; 4] = *b"LIE\x1a";

/// Version of everything but the header itself, the hello and the refusal, whose layouts
/// never change.
pub const PROTOCOL_VERSION: u16 = 7;

/// What precedes every body: magic, then version, kind and body length, little-endian.
///
/// This layout is the same in every version of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// The sender's protocol version.
    pub version: u16,
    /// What the body is.
    pub kind: u16,
    /// Bytes of body that follow.
    pub length: u32,
}

impl Header {
    /// Bytes of a header.
    pub const LENGTH: usize = 12;

    /// The header as bytes.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::LENGTH] {
        let mut bytes = [0; Self::LENGTH];
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4..6].copy_from_slice(&self.version.to_le_bytes());
        bytes[6..8].copy_from_slice(&self.kind.to_le_bytes());
        bytes[8..].copy_from_slice(&self.length.to_le_bytes());
        bytes
    }

    /// Whether a frame may begin like this.
    ///
    /// # Errors
    /// [`ProtocolError::Magic`].
    pub fn check_magic(first: [u8; MAGIC.len()]) -> Result<(), ProtocolError> {
        if first == MAGIC {
            Ok(())
        } else {
            Err(ProtocolError::Magic(first))
        }
    }

    /// Reads a header. Version, kind and length are for the caller to judge.
    ///
    /// # Errors
    /// [`ProtocolError::Magic`].
    pub fn from_bytes(bytes: [u8; Self::LENGTH]) -> Result<Self, ProtocolError> {
        let [m0, m1, m2, m3, v0, v1, k0, k1, l0, l1, l2, l3] = bytes;
        Self::check_magic([m0, m1, m2, m3])?;
        Ok(Self {
            version: u16::from_le_bytes([v0, v1]),
            kind: u16::from_le_bytes([k0, k1]),
            length: u32::from_le_bytes([l0, l1, l2, l3]),
        })
    }
}
