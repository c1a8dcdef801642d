use super::{Processes, read};

/// Who talks to whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Way {
    /// Whoever dials, first.
    Opening,
    /// The constructor, to a shader.
    ConstructorToShader,
    /// A shader, to the constructor.
    ShaderToConstructor,
    /// The constructor, to a client.
    ConstructorToClient,
    /// A client, to the constructor.
    ClientToConstructor,
    /// A shader, to a client.
    ShaderToClient,
    /// A client, to a shader.
    ClientToShader,
    /// The constructor, to an observer.
    ConstructorToObserver,
}

impl Way {
    /// All there are, each at its number.
    pub const ALL: [Self; 8] = [
        Self::Opening,
        Self::ConstructorToShader,
        Self::ShaderToConstructor,
        Self::ConstructorToClient,
        Self::ClientToConstructor,
        Self::ShaderToClient,
        Self::ClientToShader,
        Self::ConstructorToObserver,
    ];

    /// Reads what comes this way, and does with it what the process at its end does. Says
    /// whether there was a whole message.
    pub(super) fn read(self, to: &mut Processes, bytes: &[u8]) -> bool {
        match self {
            Self::Opening => read(bytes, |message| to.opening(message)),
            Self::ConstructorToShader => read(bytes, |message| to.shader(message)),
            Self::ShaderToConstructor => read(bytes, |message| to.constructor(message)),
            Self::ConstructorToClient => read(bytes, |message| to.client(message)),
            Self::ClientToConstructor => read(bytes, |message| to.constructor_of_client(message)),
            Self::ShaderToClient => read(bytes, |message| to.client_of_shader(message)),
            Self::ClientToShader => read(bytes, |message| to.shader_of_client(message)),
            Self::ConstructorToObserver => read(bytes, |message| to.observer(message)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_at_its_number() {
        for (number, way) in Way::ALL.into_iter().enumerate() {
            assert_eq!(way as usize, number);
        }
    }
}
