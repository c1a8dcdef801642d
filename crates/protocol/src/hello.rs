//! How a connection opens. The layouts here are the same in every version of the protocol,
//! so that two builds that cannot work together can at least say so.

use crate::{PROTOCOL_VERSION, Text, body::Body, limit};

/// What a process is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Holds the scene and learns the LIEs.
    Constructor,
    /// Renders tiles.
    Shader,
    /// Wants pictures.
    Client,
    /// Wants to know how the farm is, once.
    Observer,
    /// Is taken for a shader, and answers with costs that were recorded, not with pictures.
    Replay,
}

/// The first message on a connection, from the side that dialled.
///
/// Body: version (u16), role (u8: 0 to 4 as in [`Role`]), threads (u32), listen port
/// (u16), length of the build text (u16) and the text. More may follow in other versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Protocol version.
    pub protocol_version: u16,
    /// What dialled.
    pub role: Role,
    /// Render threads; 0 for all but shaders and replays.
    pub threads: u32,
    /// Where a shader takes clients, at the address it dials from; 0 for none.
    pub listen_port: u16,
    /// The build, for people.
    pub build: Text,
}

/// The answer to a hello that cannot be granted; the connection then closes.
///
/// Body: length of the text (u16) and the text. More may follow in other versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refuse {
    /// Why, for people.
    pub reason: Text,
}

const HELLO: u16 = 1;
const REFUSE: u16 = 2;

messages! {
    /// What may come on a connection before it is welcome.
    Opening {
        /// Who dials.
        Hello(Hello) = 1, at most limit::OPENING;
        /// Why not.
        Refuse(Refuse) = 2, at most limit::OPENING;
    }
}

pub(crate) fn is_timeless(kind: u16) -> bool {
    kind == HELLO || kind == REFUSE
}

impl Hello {
    /// Whether this peer can be talked to, and if not, what to tell it.
    ///
    /// # Errors
    /// The refusal, naming both versions and both builds.
    pub fn check_version(&self, build: &str) -> Result<(), Refuse> {
        if self.protocol_version == PROTOCOL_VERSION {
            return Ok(());
        }
        Err(Refuse::new(&format!(
            "you speak protocol version {} ({}), this process speaks version {} ({build}); \
             run the same build on both sides",
            self.protocol_version, self.build, PROTOCOL_VERSION
        )))
    }
}

impl Refuse {
    /// A refusal for a reason.
    #[must_use]
    pub fn new(reason: &str) -> Self {
        Self {
            reason: Text::new(reason),
        }
    }
}

impl Body for Hello {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        out.extend_from_slice(&self.protocol_version.to_le_bytes());
        out.push(match self.role {
            Role::Constructor => 0,
            Role::Shader => 1,
            Role::Client => 2,
            Role::Observer => 3,
            Role::Replay => 4,
        });
        out.extend_from_slice(&self.threads.to_le_bytes());
        out.extend_from_slice(&self.listen_port.to_le_bytes());
        write_text(&self.build, out);
        Ok(())
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        let (version, bytes) = take::<2>(bytes)?;
        let ([role], bytes) = take::<1>(bytes)?;
        let (threads, bytes) = take::<4>(bytes)?;
        let (listen_port, bytes) = take::<2>(bytes)?;
        let protocol_version = u16::from_le_bytes(version);
        Ok(Self {
            protocol_version,
            role: match role {
                0 => Role::Constructor,
                1 => Role::Shader,
                2 => Role::Client,
                3 => Role::Observer,
                4 => Role::Replay,
                // A later version may know more roles; it is refused for its version.
                _ if protocol_version != PROTOCOL_VERSION => Role::Client,
                other => return Err(format!("there is no role {other}")),
            },
            threads: u32::from_le_bytes(threads),
            listen_port: u16::from_le_bytes(listen_port),
            build: read_text(bytes, protocol_version != PROTOCOL_VERSION)?,
        })
    }
}

impl Body for Refuse {
    fn write(&self, out: &mut Vec<u8>) -> Result<(), String> {
        write_text(&self.reason, out);
        Ok(())
    }

    fn read(bytes: &[u8]) -> Result<Self, String> {
        let reason = read_text(bytes, true)?;
        Ok(Self { reason })
    }
}

fn write_text(text: &Text, out: &mut Vec<u8>) {
    // A text is at most `limit::TEXT` bytes, which fits.
    out.extend_from_slice(&(text.as_str().len() as u16).to_le_bytes());
    out.extend_from_slice(text.as_str().as_bytes());
}

fn read_text(bytes: &[u8], more_may_follow: bool) -> Result<Text, String> {
    let (length, bytes) = take::<2>(bytes)?;
    let length = usize::from(u16::from_le_bytes(length));
    let text = bytes.get(..length).ok_or("it ends within a text")?;
    if bytes.len() > length && !more_may_follow {
        return Err(format!("{} bytes follow its end", bytes.len() - length));
    }
    Ok(Text::new(&String::from_utf8_lossy(text)))
}

fn take<const N: usize>(bytes: &[u8]) -> Result<([u8; N], &[u8]), String> {
    bytes
        .split_first_chunk()
        .map(|(taken, rest)| (*taken, rest))
        .ok_or_else(|| "it is too short".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Decoder, Header, MAGIC};

    #[test]
    fn another_version_is_understood_well_enough_to_be_refused() {
        // A hello from the future: a role we have never heard of, and more than we know.
        let mut body = vec![9, 0, 77, 1, 0, 0, 0, 2, 0, 4, 0];
        body.extend_from_slice(b"v9.0and more");
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&[9, 0, 1, 0]);
        bytes.extend_from_slice(&(body.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&body);
        let mut decoder = Decoder::default();
        decoder.push(&bytes);
        let Some(Opening::Hello(hello)) = decoder.next().unwrap() else {
            panic!("a hello");
        };
        assert_eq!(hello.build.as_str(), "v9.0");
        let refusal = hello.check_version("v1.0").unwrap_err();
        let ours = format!("version {PROTOCOL_VERSION}");
        for part in ["version 9", "v9.0", &ours, "v1.0"] {
            assert!(refusal.reason.as_str().contains(part), "{refusal:?}");
        }
    }

    #[test]
    fn the_layout_stands_still() {
        let hello = Hello {
            protocol_version: PROTOCOL_VERSION,
            role: Role::Shader,
            threads: 8,
            listen_port: 0x1234,
            build: Text::new("b"),
        };
        let mut bytes = Vec::new();
        crate::encode(&Opening::Hello(hello), &mut bytes).unwrap();
        let version = PROTOCOL_VERSION as u8;
        let body = [version, 0, 1, 8, 0, 0, 0, 0x34, 0x12, 1, 0, b'b'];
        let header = [b'L', b'I', b'E', 0x1a, version, 0, 1, 0, 12, 0, 0, 0];
        assert_eq!(bytes[..Header::LENGTH], header);
        assert_eq!(bytes[Header::LENGTH..], body);
    }
}
