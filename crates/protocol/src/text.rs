use std::fmt;

use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error, Visitor},
};

use crate::limit;

/// A short text for people: at most [`limit::TEXT`] bytes, without control characters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Text(String);

impl Text {
    /// Cuts what is too long and replaces control characters: a peer's text may end in a
    /// terminal or a log.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let mut kept = String::new();
        for character in text.chars() {
            let character = if character.is_control() {
                ' '
            } else {
                character
            };
            if kept.len() + character.len_utf8() > limit::TEXT {
                break;
            }
            kept.push(character);
        }
        Self(kept)
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Text {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_str(TextVisitor)
    }
}

/// Looks at the text where it is: bincode would make room for an owned one by its length alone,
/// before it knows whether there are so many bytes.
struct TextVisitor;

impl Visitor<'_> for TextVisitor {
    type Value = Text;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "a text of at most {} bytes", limit::TEXT)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Text, E> {
        if text.len() > limit::TEXT || text.chars().any(char::is_control) {
            return Err(E::custom("a text is too long or has control characters"));
        }
        Ok(Text(text.to_owned()))
    }
}
