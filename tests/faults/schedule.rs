//! Which fault comes when: the same for the same seed, but for what the machine makes of it.

use std::time::Duration;

/// What is broken, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    ShaderKilled,
    ShaderStopped,
    ShaderCutOff,
    ShaderSilent,
    ShaderSlowed,
    LinkSlowed,
    ClientKilled,
    ConstructorKilled,
    ConstructorStopped,
}

const KINDS: [Kind; 9] = [
    Kind::ShaderKilled,
    Kind::ShaderStopped,
    Kind::ShaderCutOff,
    Kind::ShaderSilent,
    Kind::ShaderSlowed,
    Kind::LinkSlowed,
    Kind::ClientKilled,
    Kind::ConstructorKilled,
    Kind::ConstructorStopped,
];

impl Kind {
    /// Whether it happens to a shader or its connections.
    pub(crate) fn is_of_a_shader(self) -> bool {
        !matches!(
            self,
            Self::ClientKilled | Self::ConstructorKilled | Self::ConstructorStopped
        )
    }
}

/// One fault.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fault {
    pub(crate) kind: Kind,
    /// Which of the shaders that are whole; to be taken modulo their number.
    pub(crate) choice: usize,
    /// After the one before.
    pub(crate) pause: Duration,
    pub(crate) lasts: Duration,
}

/// So many faults. Every kind comes as often as any other. What is silent is so for seconds; of the others one in eight
/// lasts longer than the silence after which a peer counts as dead.
pub(crate) fn faults(seed: u64, count: usize) -> Vec<Fault> {
    let mut random = Random(seed);
    let mut kinds = Vec::new();
    let fault = |index: usize| {
        if index.is_multiple_of(KINDS.len()) {
            kinds = KINDS.to_vec();
        }
        let kind = kinds.swap_remove(random.below(kinds.len()));
        let lasts_ms = match (kind, random.below(8)) {
            // Past what a frame may take, and often past what makes a peer dead.
            (Kind::ShaderStopped | Kind::ShaderSilent, _) => 2000 + random.below(5000),
            (_, 0) => 5500 + random.below(1500),
            _ => 200 + random.below(1300),
        };
        Fault {
            kind,
            choice: random.below(1 << 16),
            pause: Duration::from_millis(50 + random.below(500) as u64),
            lasts: Duration::from_millis(lasts_ms as u64),
        }
    };
    (0..count).map(fault).collect()
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }
}
