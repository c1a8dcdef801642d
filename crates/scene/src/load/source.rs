//! Bytes from files and URIs, with their limits.

use std::path::{Path, PathBuf};

use super::LoadError;

/// Longest file that is read.
pub const MAX_FILE_BYTES: u64 = 2 << 30;

/// The whole file, if it is not too long.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, LoadError> {
    let io = |source| LoadError::Io {
        path: path.to_owned(),
        source,
    };
    let metadata = std::fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        let kind = std::io::ErrorKind::InvalidInput;
        return Err(io(std::io::Error::new(kind, "it is not a regular file")));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(LoadError::TooLarge {
            path: path.to_owned(),
            bytes: metadata.len(),
        });
    }
    std::fs::read(path).map_err(io)
}

/// What a URI points to.
pub(super) enum Target {
    /// The bytes that a `data:` URI holds.
    Data(Vec<u8>),
    /// A file, relative to the folder of the file that refers to it.
    File(PathBuf),
}

/// Resolves a URI: `data:` with base64 or percent-encoded bytes, or a relative path.
/// Anything that would leave the file system or name an absolute path is refused.
pub(super) fn resolve(uri: &str, folder: &Path) -> Result<Target, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (header, payload) = data.split_once(',').ok_or("a data: URI without a comma")?;
        let bytes = percent_decode(payload)?;
        return if header.ends_with(";base64") {
            base64_decode(&bytes).map(Target::Data)
        } else {
            Ok(Target::Data(bytes))
        };
    }
    if uri.contains("://") {
        return Err(format!("'{}' is not a relative path", shorten(uri)));
    }
    let decoded = String::from_utf8(percent_decode(uri)?)
        .map_err(|_| format!("'{}' is not UTF-8 once decoded", shorten(uri)))?;
    relative_file(&decoded, folder).map(Target::File)
}

/// A relative path with either kind of slash, below or beside `folder`.
pub(super) fn relative_file(name: &str, folder: &Path) -> Result<PathBuf, String> {
    let name = name.replace('\\', "/");
    let path = Path::new(&name);
    if name.is_empty() || name.contains('\0') || path.is_absolute() || name.get(1..3) == Some(":/")
    {
        return Err(format!("'{}' is not a relative path", shorten(&name)));
    }
    Ok(folder.join(path))
}

/// The beginning of a text from a file, fit for a message.
pub(super) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

fn percent_decode(text: &str) -> Result<Vec<u8>, String> {
    let bytes = text.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut index = 0;
    while index < bytes.len() {
        if bytes[index] == b'%' {
            let byte = bytes
                .get(index + 1..index + 3)
                .and_then(|digits| std::str::from_utf8(digits).ok())
                .and_then(|digits| u8::from_str_radix(digits, 16).ok())
                .ok_or_else(|| format!("'{}' has a % without two hex digits", shorten(text)))?;
            decoded.push(byte);
            index += 3;
        } else {
            decoded.push(bytes[index]);
            index += 1;
        }
    }
    Ok(decoded)
}

fn base64_decode(text: &[u8]) -> Result<Vec<u8>, String> {
    let mut decoded = Vec::with_capacity(text.len() / 4 * 3);
    let (mut buffer, mut bits) = (0u32, 0);
    for &byte in text {
        let digit = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            _ if byte.is_ascii_whitespace() => continue,
            _ => return Err("a data: URI that is not base64".into()),
        };
        buffer = (buffer << 6) | u32::from(digit);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            decoded.push((buffer >> bits) as u8);
        }
    }
    Ok(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_decoded() {
        let data = |uri: &str| match resolve(uri, Path::new("folder")) {
            Ok(Target::Data(bytes)) => bytes,
            _ => panic!("{uri} is data"),
        };
        assert_eq!(data("data:;base64,aGVsbG8="), b"hello");
        assert_eq!(
            data("data:application/octet-stream;base64,AP8B"),
            [0, 255, 1]
        );
        assert_eq!(data("data:text/plain,a%20b"), b"a b");
        let file = |uri: &str| match resolve(uri, Path::new("folder")) {
            Ok(Target::File(path)) => path,
            _ => panic!("{uri} is a file"),
        };
        assert_eq!(file("my%20texture.png"), Path::new("folder/my texture.png"));
        assert_eq!(file("..\\a.bin"), Path::new("folder/../a.bin"));
        for bad in [
            "",
            "/etc/passwd",
            "C:/x",
            "http://x/y",
            "a%2",
            "a%zz",
            "data:x",
            "data:;base64,?",
        ] {
            assert!(resolve(bad, Path::new("folder")).is_err(), "{bad}");
        }
    }
}
