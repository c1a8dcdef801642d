//! LIEs on disk, so that a restart goes on where construction was.
//!
//! [`SnapshotFile`] is the file, [`Snapshot`] what is in it. A file is taken over only if it is
//! whole, of this format, of the same scene (by the hash of its bytes) and of the same
//! settings. Any other snapshot is refused with a warning and replaced at the next save; what
//! is no snapshot at all is an error, and never touched.

mod container;
mod views;

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
    time::Instant,
};

use lie_octree::{TreeError, TreeFit};
use lie_protocol::SceneHash;
use lie_scene::Scene;

pub use crate::construct::Snapshot;
use crate::{
    Builder, file,
    scene_blob::{self, BlobError},
};
use container::Contents;

/// Where LIEs are kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SnapshotFile {
    path: PathBuf,
}

/// Why a file cannot hold snapshots; it is left as it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// Something else is there.
    #[error("{}: this is no snapshot of LIEs; it is left as it is", .0.display())]
    Foreign(PathBuf),
    /// It cannot be looked at.
    #[error("{}: cannot be read: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// It cannot be written.
    #[error("{}: the LIEs cannot be saved: {cause}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// Why a snapshot is not taken over.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// Something else, not a snapshot at all.
    #[error("it is no snapshot of LIEs")]
    Foreign,
    /// It is of another format.
    #[error("its format is {found}, not {expected}")]
    Format {
        /// What it is.
        found: String,
        /// What is read here.
        expected: String,
    },
    /// There are fewer or more bytes than it says.
    #[error("it should have {expected} bytes and has {found}")]
    Length {
        /// What there is.
        found: u64,
        /// What there should be.
        expected: u64,
    },
    /// Its bytes are not those that were written.
    #[error("it is damaged")]
    Checksum,
    /// It is of another scene.
    #[error("it is of another scene")]
    Scene,
    /// Its views cannot be read.
    #[error("its views are malformed: {0}")]
    Views(String),
    /// Lights were settled by geometry where they should not be, or the reverse.
    #[error("it was constructed {}", if *.0 { "with proofs" } else { "without proofs" })]
    Proofs(bool),
    /// Its tree does not fit.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

impl SnapshotFile {
    /// A file, which need not be there.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// Its name.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Finds out whether there is a snapshot or nothing, before anything else is begun.
    ///
    /// # Errors
    /// [`SnapshotError`] if there is something else, or nothing can be.
    pub fn check(&self) -> Result<(), SnapshotError> {
        let folder = self.path.parent();
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
        if folder.is_some_and(|folder| !folder.is_dir()) || self.path.file_name().is_none() {
            let cause = io::Error::new(io::ErrorKind::NotFound, "there is no such folder");
            return Err(self.cannot_write(cause));
        }
        self.open().map(|_| ())
    }

    /// Lets a builder go on from what was saved. Says whether it does: nothing happens if there
    /// is no file, and a snapshot that is refused is a warning.
    ///
    /// # Errors
    /// [`SnapshotError`] if there is something else than a snapshot.
    pub fn restore(&self, builder: &mut Builder, scene: SceneHash) -> Result<bool, SnapshotError> {
        let clock = Instant::now();
        let Some(mut file) = self.open()? else {
            return Ok(false);
        };
        let mut bytes = vec![];
        let expected =
            container::expected_length(&mut file).map_err(|cause| self.cannot_read(cause))?;
        // One more than there should be tells that there are more.
        let most = expected.min(container::LONGEST).saturating_add(1);
        let read = file.take(most).read_to_end(&mut bytes);
        read.map_err(|cause| self.cannot_read(cause))?;
        match decode(&bytes, builder, scene) {
            Ok(snapshot) => {
                builder.restore(snapshot);
                let (path, took) = (self.path.display(), clock.elapsed());
                tracing::info!("{path}: {} bytes of LIEs read in {took:.1?}", bytes.len());
                Ok(true)
            }
            Err(refusal) => {
                let path = self.path.display();
                tracing::warn!("{path}: {refusal}; LIEs are constructed anew and replace it");
                Ok(false)
            }
        }
    }

    /// Replaces what was saved, all or nothing.
    ///
    /// # Errors
    /// [`SnapshotError`]; the file is then as it was.
    pub fn save(&self, snapshot: &Snapshot, scene: SceneHash) -> Result<(), SnapshotError> {
        let clock = Instant::now();
        self.open()?;
        let bytes = encode(snapshot, scene).map_err(|cause| self.cannot_write(cause))?;
        // A link stays one.
        let path = fs::canonicalize(&self.path).unwrap_or_else(|_| self.path.clone());
        file::replace(&path, &bytes).map_err(|cause| self.cannot_write(cause))?;
        let (path, took) = (self.path.display(), clock.elapsed());
        tracing::info!("{path}: {} bytes of LIEs saved in {took:.1?}", bytes.len());
        Ok(())
    }

    /// The snapshot, to be read from its start, if there is one.
    fn open(&self) -> Result<Option<File>, SnapshotError> {
        let foreign = || Err(SnapshotError::Foreign(self.path.clone()));
        // Opening a pipe would wait for its other end.
        match fs::metadata(&self.path) {
            Ok(found) if !found.is_file() => return foreign(),
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(self.cannot_read(cause)),
        }
        let look = || {
            let mut start = vec![];
            let file = File::open(&self.path)?;
            file.take(8).read_to_end(&mut start)?;
            Ok((start, File::open(&self.path)?))
        };
        match look().map_err(|cause| self.cannot_read(cause))? {
            (start, file) if container::may_be_one(&start) => Ok(Some(file)),
            _ => foreign(),
        }
    }

    fn cannot_read(&self, cause: io::Error) -> SnapshotError {
        SnapshotError::Read {
            path: self.path.clone(),
            cause,
        }
    }

    fn cannot_write(&self, cause: io::Error) -> SnapshotError {
        SnapshotError::Write {
            path: self.path.clone(),
            cause,
        }
    }
}

/// What a scene is called in snapshots: the name that shaders know it by.
///
/// # Errors
/// [`BlobError`] if it is too large for any peer.
pub fn scene_hash(scene: &Scene) -> Result<SceneHash, BlobError> {
    scene_blob::encode(scene).map(|bytes| scene_blob::hash_of(&bytes))
}

fn encode(snapshot: &Snapshot, scene: SceneHash) -> io::Result<Vec<u8>> {
    let contents = Contents {
        scene,
        views: views::encode(snapshot).map_err(io::Error::other)?,
        tree: snapshot.tree.to_bytes(),
    };
    let bytes = container::encode(&contents);
    if bytes.len() as u64 > container::LONGEST {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    Ok(bytes)
}

/// What was saved, if this builder may go on from there.
fn decode(bytes: &[u8], builder: &Builder, scene: SceneHash) -> Result<Snapshot, Refusal> {
    let contents = container::decode(bytes, scene)?;
    let views = views::decode(contents.views).map_err(Refusal::Views)?;
    if views.proofs != builder.has_proofs() {
        return Err(Refusal::Proofs(views.proofs));
    }
    let scene = builder.world().scene();
    let fit = TreeFit {
        bounds: scene.geometry.bounds(),
        lights: scene.lights.len() as u32,
        triangles: scene.geometry.len() as u32,
        settings: builder.tree().settings(),
    };
    Ok(Snapshot {
        tree: lie_octree::LieTree::from_bytes(contents.tree, &fit)?,
        views: views.views,
        proofs: views.proofs,
    })
}

#[cfg(test)]
mod tests;
