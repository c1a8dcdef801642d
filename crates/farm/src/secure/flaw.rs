//! What can be wrong with a bundle.

use std::{io, path::PathBuf};

use super::{NODE_NAME, bundle::date};

/// Why a bundle cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BundleError {
    /// It cannot be read.
    #[error("cannot read the bundle {origin}: {cause}")]
    Read {
        /// Which file.
        origin: String,
        /// What the system says.
        cause: io::Error,
    },
    /// It cannot be written.
    #[error("cannot write the bundle {}: {cause}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// Something is there already.
    #[error("{} is there already and is only replaced with --force", .0.display())]
    Exists(PathBuf),
    /// What is in it is no bundle, or none for now.
    #[error("the bundle {place}: {flaw}")]
    Flaw {
        /// The file, and the line if there is one to blame, as `FILE:LINE`.
        place: String,
        /// What is wrong there.
        flaw: Flaw,
    },
}

/// What is wrong with the content of a bundle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Flaw {
    /// Far more than any bundle has.
    #[error("it is longer than {0} bytes, so this is no bundle")]
    TooLong(usize),
    /// Bytes that are no text.
    #[error("it is not text, so this is no bundle")]
    NotText,
    /// No block at all.
    #[error("there is no certificate in it, so this is no bundle; `lie key new` makes one")]
    Empty,
    /// A block that is cut off.
    #[error("the block '{0}' that begins here has no end")]
    NoEnd(String),
    /// An end of nothing.
    #[error("a block ends here that never began")]
    NoBegin,
    /// Not base64 in between.
    #[error("the block '{label}' that begins here cannot be read: {cause}")]
    Encoding {
        /// What the block says that it is.
        label: String,
        /// What is wrong.
        cause: String,
    },
    /// Something that has no place here.
    #[error(
        "a block '{0}' does not belong into a bundle, which has certificates and a private key"
    )]
    Kind(String),
    /// No certificate, though it says so.
    #[error("the certificate that begins here is malformed: {0}")]
    Certificate(String),
    /// Nothing to show to others.
    #[error("a node's certificate is missing: all that are in it are authorities'")]
    NoNode,
    /// It is not clear what to show to others.
    #[error("a second node's certificate; a bundle has one")]
    SecondNode,
    /// Nothing to prove one's identity with.
    #[error("the private key is missing")]
    NoKey,
    /// It is not clear what to prove one's identity with.
    #[error("a second private key; a bundle has one")]
    SecondKey,
    /// Nobody to trust.
    #[error("the certificate of an authority is missing, so that nobody could be trusted")]
    NoAuthority,
    /// More to trust than anybody can have an eye on.
    #[error("more than {0} authorities")]
    Authorities(usize),
    /// The private key is of no kind that is known.
    #[error("the private key cannot be used: {0}")]
    Key(String),
    /// Certificate and key are not of one pair.
    #[error("the private key is not that of the node's certificate")]
    KeyMismatch,
    /// The others would not trust this node.
    #[error("the node's certificate was issued by none of the authorities in the bundle")]
    Unissued,
    /// A certificate for something else.
    #[error("the node's certificate is not one of a cluster's node, '{NODE_NAME}': {0}")]
    Purpose(String),
    /// Its time is over; in seconds since 1970.
    #[error(
        "the node's certificate has expired: it was valid until {}; \
         `lie key new` makes another bundle", date(*.0)
    )]
    Expired(i64),
    /// Its time has not come; in seconds since 1970.
    #[error("the node's certificate is not valid before {}; is the clock right?", date(*.0))]
    NotYetValid(i64),
}

impl Flaw {
    /// The error of that flaw at a place.
    pub(super) fn at(self, place: impl Into<String>) -> BundleError {
        BundleError::Flaw {
            place: place.into(),
            flaw: self,
        }
    }
}
