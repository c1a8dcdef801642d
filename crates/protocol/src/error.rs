use crate::PROTOCOL_VERSION;

/// Why bytes are not a message, or a message cannot be sent.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProtocolError {
    /// The peer does not speak this protocol at all.
    #[error("what arrived does not speak lie's protocol (it begins with {0:02x?})")]
    Magic([u8; 4]),
    /// The peer speaks another version.
    #[error("the peer speaks protocol version {theirs}, this is version {PROTOCOL_VERSION}")]
    Version {
        /// The peer's version.
        theirs: u16,
    },
    /// The kind is unknown, or has no place in this conversation.
    #[error("a message of kind {0} has no place here")]
    Kind(u16),
    /// The body is longer than its kind allows.
    #[error("a message of kind {kind} with {length} bytes is over its limit of {max}")]
    TooLong {
        /// Kind of the message.
        kind: u16,
        /// Length claimed or needed.
        length: u64,
        /// Its limit.
        max: u32,
    },
    /// The body is not what its kind promises.
    #[error("a message of kind {kind} is malformed: {reason}")]
    Malformed {
        /// Kind of the message.
        kind: u16,
        /// What is wrong.
        reason: String,
    },
}
