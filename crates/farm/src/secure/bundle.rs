//! A cluster's bundle: what a process needs to belong to it, in one PEM file.

use std::{
    fmt,
    fs::File,
    io::{self, BufRead, Read},
    path::Path,
};

use pem::{EncodeConfig, LineEnding, Pem};
use rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer, PrivateSec1KeyDer};
use x509_parser::prelude::{FromDer, X509Certificate};

use super::{
    BundleError, Flaw,
    blocks::{Block, blocks},
};
use crate::file;

/// The certificate and private key of a node, and the authorities that it trusts.
///
/// A certificate that may issue others is an authority's; the order in the file is of no
/// meaning. The structure has been checked; whether the certificate is good for now is checked by
/// [`Cluster::new`](super::Cluster::new).
pub struct Bundle {
    /// Where it is from, for people.
    pub(super) origin: String,
    pub(super) node: CertificateDer<'static>,
    pub(super) key: PrivateKeyDer<'static>,
    pub(super) authorities: Vec<CertificateDer<'static>>,
    pub(super) validity: Validity,
}

/// From when to when a certificate holds, in seconds since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Validity {
    /// The first second.
    pub not_before: i64,
    /// The last second.
    pub not_after: i64,
}

impl Bundle {
    /// Longest bundle, in bytes.
    pub const MAX_LENGTH: usize = 64 * 1024;
    /// Most authorities in one bundle.
    pub const MAX_AUTHORITIES: usize = 8;
    /// The last line. One that is read from standard input ends here.
    const LAST_LINE: &str = "# end of bundle";

    /// Reads a file. If others than its owner may read it too, there is a warning.
    ///
    /// # Errors
    /// [`BundleError`], which names the file and the line.
    pub fn read(path: &Path) -> Result<Self, BundleError> {
        let origin = path.display().to_string();
        let open = || {
            let file = File::open(path)?;
            warn_if_open(path, &file)?;
            let mut bytes = Vec::new();
            file.take(Self::MAX_LENGTH as u64 + 1)
                .read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        match open() {
            Ok(bytes) => Self::parse(&bytes, origin),
            Err(cause) => Err(BundleError::Read { origin, cause }),
        }
    }

    /// Reads a bundle that somebody hands over; what follows its last line is left alone.
    ///
    /// # Errors
    /// [`BundleError`], which names the origin and the line.
    pub fn receive(from: impl BufRead, origin: impl Into<String>) -> Result<Self, BundleError> {
        let origin = origin.into();
        let mut from = from.take(Self::MAX_LENGTH as u64 + 1);
        let mut bytes = Vec::new();
        loop {
            let start = bytes.len();
            match from.read_until(b'\n', &mut bytes) {
                Ok(0) => break,
                Ok(_) if bytes[start..].trim_ascii() == Self::LAST_LINE.as_bytes() => break,
                Ok(_) => {}
                Err(cause) => return Err(BundleError::Read { origin, cause }),
            }
        }
        Self::parse(&bytes, origin)
    }

    /// Reads a bundle from standard input, up to its last line.
    ///
    /// # Errors
    /// As of [`Self::receive`].
    pub fn from_standard_input() -> Result<Self, BundleError> {
        // All who read standard input share its buffer: what follows is not lost.
        Self::receive(io::stdin().lock(), "from standard input")
    }

    /// Takes a bundle apart. `origin` is what errors call it.
    ///
    /// # Errors
    /// [`BundleError::Flaw`].
    pub fn parse(bytes: &[u8], origin: impl Into<String>) -> Result<Self, BundleError> {
        let origin = origin.into();
        if bytes.len() > Self::MAX_LENGTH {
            return Err(Flaw::TooLong(Self::MAX_LENGTH).at(origin));
        }
        let Ok(text) = std::str::from_utf8(bytes) else {
            return Err(Flaw::NotText.at(origin));
        };
        let at = |(line, flaw): (usize, Flaw)| flaw.at(format!("{origin}:{line}"));
        let mut parts = Parts::default();
        for block in blocks(text).map_err(at)? {
            let line = block.line;
            parts.take(block).map_err(|flaw| at((line, flaw)))?;
        }
        match parts.whole() {
            Ok((node, key, authorities, validity)) => Ok(Self {
                origin,
                node,
                key,
                authorities,
                validity,
            }),
            Err(flaw) => Err(flaw.at(origin)),
        }
    }

    /// The content of the file. Whoever has it belongs to the cluster.
    #[must_use]
    pub fn to_pem(&self) -> String {
        let mut text = format!(
            "# A node of the cluster {}.\n\
             # Whoever has this file belongs to the cluster: keep it secret.\n\
             # Valid until {}.\n",
            self.fingerprint(),
            date(self.validity.not_after)
        );
        let label = match &self.key {
            PrivateKeyDer::Sec1(_) => "EC PRIVATE KEY",
            _ => "PRIVATE KEY",
        };
        let authorities = self.authorities.iter().map(|der| ("CERTIFICATE", &der[..]));
        let node = [
            ("CERTIFICATE", &self.node[..]),
            (label, self.key.secret_der()),
        ];
        let config = EncodeConfig::new().set_line_ending(LineEnding::LF);
        for (label, bytes) in node.into_iter().chain(authorities) {
            text += &pem::encode_config(&Pem::new(label, bytes), config);
        }
        text + Self::LAST_LINE + "\n"
    }

    /// Writes the file, readable by its owner alone; one that is there is only replaced with
    /// `force`.
    ///
    /// # Errors
    /// [`BundleError::Write`] or [`BundleError::Exists`].
    pub fn write(&self, path: &Path, force: bool) -> Result<(), BundleError> {
        let text = self.to_pem();
        let written = if force {
            file::replace(path, text.as_bytes())
        } else {
            file::create(path, text.as_bytes())
        };
        let path = path.to_owned();
        written.map_err(|cause| match cause.kind() {
            io::ErrorKind::AlreadyExists => BundleError::Exists(path),
            _ => BundleError::Write { path, cause },
        })
    }

    /// The same node, which trusts the clusters of other bundles as well.
    ///
    /// # Errors
    /// [`Flaw::Authorities`] if that makes too many.
    pub fn trusting<'a>(
        mut self,
        others: impl IntoIterator<Item = &'a Self>,
    ) -> Result<Self, BundleError> {
        for authority in others.into_iter().flat_map(|other| &other.authorities) {
            if !self.authorities.contains(authority) {
                self.authorities.push(authority.clone());
            }
        }
        if self.authorities.len() > Self::MAX_AUTHORITIES {
            return Err(Flaw::Authorities(Self::MAX_AUTHORITIES).at(self.origin));
        }
        Ok(self)
    }

    /// From when to when its certificate holds.
    #[must_use]
    pub fn validity(&self) -> Validity {
        self.validity
    }

    /// SHA-256 of the authority that issued its certificate: what the cluster is known by.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        let issuer = self.authorities.iter().find(|der| issued(der, &self.node));
        fingerprint(issuer.unwrap_or(&self.authorities[0]))
    }

    /// The same of all authorities that it trusts.
    pub fn trusted(&self) -> impl Iterator<Item = String> {
        self.authorities.iter().map(|der| fingerprint(der))
    }
}

impl fmt::Debug for Bundle {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Bundle");
        shown.field("origin", &self.origin).finish_non_exhaustive()
    }
}

/// What was found so far.
#[derive(Default)]
struct Parts {
    node: Option<(CertificateDer<'static>, Validity)>,
    key: Option<PrivateKeyDer<'static>>,
    authorities: Vec<CertificateDer<'static>>,
}

type Whole = (
    CertificateDer<'static>,
    PrivateKeyDer<'static>,
    Vec<CertificateDer<'static>>,
    Validity,
);

impl Parts {
    fn take(&mut self, block: Block) -> Result<(), Flaw> {
        let bytes = block.bytes;
        match block.label.as_str() {
            "CERTIFICATE" => self.take_certificate(bytes),
            "PRIVATE KEY" => self.take_key(PrivatePkcs8KeyDer::from(bytes).into()),
            "EC PRIVATE KEY" => self.take_key(PrivateSec1KeyDer::from(bytes).into()),
            _ => Err(Flaw::Kind(block.label)),
        }
    }

    fn take_key(&mut self, key: PrivateKeyDer<'static>) -> Result<(), Flaw> {
        match self.key.replace(key) {
            None => Ok(()),
            Some(_) => Err(Flaw::SecondKey),
        }
    }

    fn take_certificate(&mut self, bytes: Vec<u8>) -> Result<(), Flaw> {
        let (rest, read) = X509Certificate::from_der(&bytes)
            .map_err(|error| Flaw::Certificate(error.to_string()))?;
        if !rest.is_empty() {
            return Err(Flaw::Certificate("more bytes follow it".to_owned()));
        }
        let validity = Validity {
            not_before: read.validity().not_before.timestamp(),
            not_after: read.validity().not_after.timestamp(),
        };
        if read.is_ca() {
            self.authorities.push(bytes.into());
            if self.authorities.len() > Bundle::MAX_AUTHORITIES {
                return Err(Flaw::Authorities(Bundle::MAX_AUTHORITIES));
            }
            return Ok(());
        }
        match self.node.replace((bytes.into(), validity)) {
            None => Ok(()),
            Some(_) => Err(Flaw::SecondNode),
        }
    }

    fn whole(self) -> Result<Whole, Flaw> {
        if self.node.is_none() && self.key.is_none() && self.authorities.is_empty() {
            return Err(Flaw::Empty);
        }
        let (node, validity) = self.node.ok_or(Flaw::NoNode)?;
        let key = self.key.ok_or(Flaw::NoKey)?;
        if self.authorities.is_empty() {
            return Err(Flaw::NoAuthority);
        }
        Ok((node, key, self.authorities, validity))
    }
}

/// Whether an authority has the name of a certificate's issuer.
fn issued(authority: &[u8], certificate: &[u8]) -> bool {
    let names = X509Certificate::from_der(authority)
        .ok()
        .zip(X509Certificate::from_der(certificate).ok());
    names.is_some_and(|((_, authority), (_, certificate))| {
        authority.subject().as_raw() == certificate.issuer().as_raw()
    })
}

/// SHA-256 as others print it, too.
fn fingerprint(der: &[u8]) -> String {
    let digest = ring::digest::digest(&ring::digest::SHA256, der);
    let bytes: Vec<_> = digest.as_ref().iter().map(|b| format!("{b:02X}")).collect();
    format!("SHA256:{}", bytes.join(":"))
}

/// A time in seconds since 1970 for people.
pub(super) fn date(seconds: i64) -> String {
    match time::OffsetDateTime::from_unix_timestamp(seconds) {
        Ok(at) => {
            let (hour, minute, second) = at.time().as_hms();
            format!("{} {hour:02}:{minute:02}:{second:02} UTC", at.date())
        }
        Err(_) => format!("{seconds} s since 1970"),
    }
}

impl fmt::Display for Validity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            not_before,
            not_after,
        } = *self;
        write!(formatter, "{} to {}", date(not_before), date(not_after))
    }
}

/// A file that others may read is no secret. It may be meant so: a container that is nobody
/// else's, for instance.
fn warn_if_open(path: &Path, file: &File) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let found = file.metadata()?;
        let mode = found.permissions().mode() & 0o777;
        if found.is_file() && mode & 0o077 != 0 {
            tracing::warn!(
                "others than its owner may use the bundle {} (mode {mode:04o}): \
                 whoever can read it belongs to the cluster; chmod 600 it",
                path.display()
            );
        }
    }
    #[cfg(not(unix))]
    let _ = (path, file);
    Ok(())
}
