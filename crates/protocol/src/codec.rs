//! The one place that knows bincode: little-endian, variable-length integers.
//!
//! Public for the one structure outside this crate that wants the same care: a scene's
//! description in its container.

use std::fmt;

use serde::{
    Deserializer, Serialize,
    de::{DeserializeOwned, Error, Visitor},
};

use crate::limit;

/// What decoding a message may claim. bincode counts an integer by its size in memory, not
/// by the bytes it took, so a body of single-byte integers claims eight times its length;
/// eight times the longest body is never too little for an honest message.
const CLAIM: usize = 8 * limit::LIE_DELTA as usize;

/// Appends `value` to `out`.
///
/// # Errors
/// What bincode says.
pub fn write<T: Serialize>(value: &T, out: &mut Vec<u8>) -> Result<(), String> {
    bincode::serde::encode_into_std_write(value, out, bincode::config::standard())
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Reads a value from the start of `bytes`; also returns what follows it. Claims at most
/// `LIMIT` bytes of memory for integers, texts and lists of bytes.
///
/// # Errors
/// What bincode says.
pub fn read_within<T: DeserializeOwned, const LIMIT: usize>(
    bytes: &[u8],
) -> Result<(T, &[u8]), String> {
    let config = bincode::config::standard().with_limit::<LIMIT>();
    bincode::serde::decode_from_slice(bytes, config)
        .map(|(value, used)| (value, &bytes[used..]))
        .map_err(|error| error.to_string())
}

/// Reads a text, for `deserialize_with`. bincode makes room for a [`String`] by its length alone,
/// up to the limit; this copies what has been found to be there.
///
/// # Errors
/// What bincode says.
pub fn text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    struct Copied;

    impl Visitor<'_> for Copied {
        type Value = String;

        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("a text")
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<String, E> {
            Ok(text.to_owned())
        }
    }

    deserializer.deserialize_str(Copied)
}

/// [`read_within`] the limit of messages.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<(T, &[u8]), String> {
    read_within::<T, CLAIM>(bytes)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::Text;

    /// A length of 2⁴⁰ in front of nothing.
    const HOSTILE_LENGTH: [u8; 9] = [253, 0, 0, 0, 0, 0, 1, 0, 0];

    #[test]
    fn a_hostile_length_is_refused_before_it_is_allocated() {
        let text = read::<String>(&HOSTILE_LENGTH).unwrap_err();
        assert!(text.contains("LimitExceeded"), "{text}");
        assert!(read::<Vec<u64>>(&HOSTILE_LENGTH).is_err());
        assert!(read::<Vec<u8>>(&HOSTILE_LENGTH).is_err());
    }

    /// A length that bincode would allow, in front of nothing: an owned text would be allocated
    /// before it is missed. What a borrowed one is missing is said, and not taken for granted.
    #[test]
    fn texts_are_looked_at_where_they_are() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Named(#[serde(deserialize_with = "text")] String);

        let whole = b"\x03abcrest";
        let (named, rest): (Named, _) = read(whole).unwrap();
        assert_eq!((named, rest), (Named("abc".to_owned()), &b"rest"[..]));
        let (short, rest): (Text, _) = read(whole).unwrap();
        assert_eq!((short, rest), (Text::new("abc"), &b"rest"[..]));
        let missing = [&[252][..], &(1u32 << 24).to_le_bytes(), b"abc"].concat();
        for refused in [
            read::<Named>(&missing).map(drop),
            read::<Text>(&missing).map(drop),
        ] {
            let reason = refused.unwrap_err();
            assert!(reason.contains("UnexpectedEnd"), "{reason}");
        }
    }

    #[test]
    fn the_longest_body_of_the_smallest_integers_is_within_the_claim() {
        let body = vec![0u64; limit::LIE_DELTA as usize - 16];
        let mut bytes = Vec::new();
        write(&body, &mut bytes).unwrap();
        assert!(bytes.len() <= limit::LIE_DELTA as usize);
        assert_eq!(read::<Vec<u64>>(&bytes).unwrap().0.len(), body.len());
    }
}
