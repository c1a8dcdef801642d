use serde::{Serialize, de::DeserializeOwned};

use crate::codec;

/// A message without its header.
pub(crate) trait Body: Sized {
    /// Appends the body.
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String>;
    /// Reads the body from exactly these bytes.
    fn read(bytes: &[u8]) -> Result<Self, String>;
}

/// Bodies that are nothing but a control structure.
pub(crate) trait Control: Serialize + DeserializeOwned {}

impl<T: Control> Body for T {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        codec::write(self, out)
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        match codec::read(bytes)? {
            (value, []) => Ok(value),
            (_, rest) => Err(format!("{} bytes follow its end", rest.len())),
        }
    }
}
