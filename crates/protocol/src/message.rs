use crate::ProtocolError;

/// One direction of a conversation: all messages that may come that way.
pub trait Message: Sized {
    /// Longest body of a kind; `None` if that kind has no place here.
    fn max_length(kind: u16) -> Option<u32>;

    /// Whether a kind is read whatever version its sender speaks.
    #[must_use]
    fn is_timeless(kind: u16) -> bool {
        crate::hello::is_timeless(kind)
    }

    /// The message's kind.
    fn kind(&self) -> u16;

    /// Appends the body.
    ///
    /// # Errors
    /// [`ProtocolError::Malformed`] if it cannot be written.
    fn write_body(&self, out: &mut Vec<u8>) -> Result<(), ProtocolError>;

    /// Reads a body from exactly these bytes.
    ///
    /// # Errors
    /// [`ProtocolError::Malformed`] says what is wrong with it.
    fn read_body(kind: u16, bytes: &[u8]) -> Result<Self, ProtocolError>;
}

/// Defines an enum of messages: `Variant(Body) = kind, at most bytes`.
macro_rules! messages {
    (
        $(#[$about:meta])*
        $name:ident { $( $(#[$doc:meta])* $variant:ident($body:ty) = $kind:literal, at most $max:expr; )* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name { $( $(#[$doc])* $variant($body), )* }

        impl $crate::Message for $name {
            fn max_length(kind: u16) -> Option<u32> {
                match kind {
                    $( $kind => Some($max), )*
                    _ => None,
                }
            }

            fn kind(&self) -> u16 {
                match self {
                    $( Self::$variant(_) => $kind, )*
                }
            }

            fn write_body(&self, out: &mut Vec<u8>) -> Result<(), $crate::ProtocolError> {
                match self {
                    $( Self::$variant(body) => $crate::body::Body::write(body, out), )*
                }
                .map_err(|reason| $crate::ProtocolError::Malformed { kind: self.kind(), reason })
            }

            fn read_body(kind: u16, bytes: &[u8]) -> Result<Self, $crate::ProtocolError> {
                match kind {
                    $( $kind => $crate::body::Body::read(bytes).map(Self::$variant), )*
                    _ => return Err($crate::ProtocolError::Kind(kind)),
                }
                .map_err(|reason| $crate::ProtocolError::Malformed { kind, reason })
            }
        }
    };
}
