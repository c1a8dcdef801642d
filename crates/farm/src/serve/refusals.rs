use lie_protocol::ProtocolError;

use crate::{
    connection::LinkError,
    metrics::{Counter, Exposition},
    secure::HandshakeFailure as Tls,
};

/// Why a connection was not let in, as far as it is told apart in metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    OtherMachine,
    Untrusted,
    Expired,
    TlsMismatch,
    TlsFailed,
    Garbage,
    Version,
    Protocol,
    Silent,
    CrowdedOut,
    Full,
    NotTaken,
    Network,
}

impl Reason {
    const ALL: [(Self, &'static str); 13] = [
        (Self::OtherMachine, "other_machine"),
        (Self::Untrusted, "untrusted"),
        (Self::Expired, "expired"),
        (Self::TlsMismatch, "tls_mismatch"),
        (Self::TlsFailed, "tls_failed"),
        (Self::Garbage, "garbage"),
        (Self::Version, "version"),
        (Self::Protocol, "protocol"),
        (Self::Silent, "silent"),
        (Self::CrowdedOut, "crowded_out"),
        (Self::Full, "full"),
        (Self::NotTaken, "not_taken"),
        (Self::Network, "network"),
    ];

    /// Why a peer that has not said hello is gone; `None` if it went by itself.
    pub(super) fn of(error: &LinkError) -> Option<Self> {
        Some(match error {
            LinkError::Closed | LinkError::Refused(_) => return None,
            LinkError::Handshake(failure) => match failure {
                Tls::ForeignCluster
                | Tls::NoCertificate
                | Tls::Certificate(_)
                | Tls::WeAreForeign => Self::Untrusted,
                Tls::Expired | Tls::NotYetValid | Tls::WeExpired => Self::Expired,
                Tls::NotTls | Tls::Plaintext | Tls::UnexpectedTls => Self::TlsMismatch,
                Tls::Garbage => Self::Garbage,
                Tls::Incompatible(_) | Tls::Other(_) => Self::TlsFailed,
            },
            LinkError::Version(_)
            | LinkError::OtherVersion(_)
            | LinkError::Protocol(ProtocolError::Version { .. }) => Self::Version,
            LinkError::Protocol(ProtocolError::Magic(_)) => Self::Garbage,
            LinkError::Protocol(_) | LinkError::Rules(_) => Self::Protocol,
            LinkError::Silent(_) => Self::Silent,
            LinkError::CrowdedOut => Self::CrowdedOut,
            LinkError::NotTaken(_) => Self::NotTaken,
            LinkError::Io(_) | LinkError::Stuck(_) => Self::Network,
        })
    }
}

/// How many connections were not let in, and how many broke.
#[derive(Debug, Default)]
pub(crate) struct Refusals {
    refused: [Counter; Reason::ALL.len()],
    broken: Counter,
}

impl Refusals {
    /// A connection is not let in.
    pub(super) fn refused(&self, reason: Reason) {
        self.refused[reason as usize].add(1);
    }

    /// A session with a peer that was let in has ended with an error.
    pub(super) fn ended(&self, error: &LinkError) {
        match Reason::of(error) {
            Some(Reason::NotTaken) => self.refused(Reason::NotTaken),
            Some(_) => self.broken.add(1),
            None => {}
        }
    }

    /// Writes it all down.
    pub(crate) fn write(&self, text: &mut Exposition) {
        let mut family = text.counter(
            "lie_connections_refused_total",
            "Connections that were not let in, by reason.",
        );
        for (reason, name) in Reason::ALL {
            let count = self.refused[reason as usize].get();
            family.count(&[("reason", name)], count);
        }
        text.counter(
            "lie_connections_broken_total",
            "Sessions with processes of the farm that ended with an error.",
        )
        .count(&[], self.broken.get());
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn every_reason_has_its_own_place_and_name() {
        for (place, (reason, name)) in Reason::ALL.into_iter().enumerate() {
            assert_eq!(reason as usize, place);
            let same = Reason::ALL.iter().filter(|(_, other)| *other == name);
            assert_eq!(same.count(), 1, "{name}");
        }
    }

    #[test]
    fn who_leaves_is_not_refused_and_who_breaks_was_let_in() {
        let refusals = Refusals::default();
        refusals.ended(&LinkError::Closed);
        refusals.ended(&LinkError::Silent(Duration::ZERO));
        refusals.refused(Reason::Garbage);
        let mut text = Exposition::default();
        refusals.write(&mut text);
        let text = text.into_text();
        for line in [
            "lie_connections_refused_total{reason=\"garbage\"} 1\n",
            "lie_connections_refused_total{reason=\"silent\"} 0\n",
            "lie_connections_broken_total 1\n",
        ] {
            assert!(text.contains(line), "no {line} in {text}");
        }
    }
}
