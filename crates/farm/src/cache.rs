//! Scenes on the local disk, by the hash of their bytes.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use lie_protocol::SceneHash;

use crate::{file, scene_blob::hash_of};

/// A directory of scenes, one file each, named by the hash in hexadecimal.
///
/// An entry is hashed at every load: one that was cut short, tampered with or hit by a bad
/// disk is deleted, never used. Writers may race: the last rename wins, with equal bytes.
#[derive(Clone, Debug)]
pub struct SceneCache {
    directory: PathBuf,
}

impl SceneCache {
    /// Opens the directory, making it (for its owner alone) if it is not there.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn open(directory: impl Into<PathBuf>) -> io::Result<Self> {
        let directory = directory.into();
        make_private_directory(&directory)?;
        Ok(Self { directory })
    }

    /// `$XDG_CACHE_HOME/lie`, else `~/.cache/lie`; `None` without a home.
    #[must_use]
    pub fn default_directory() -> Option<PathBuf> {
        let set = |name| std::env::var_os(name).map(PathBuf::from);
        let base = set("XDG_CACHE_HOME").filter(|path| path.is_absolute());
        base.or_else(|| set("HOME").map(|home| home.join(".cache")))
            .map(|base| base.join("lie"))
    }

    /// Where a scene is, or would be.
    #[must_use]
    pub fn path(&self, hash: SceneHash) -> PathBuf {
        self.directory.join(format!("{hash}.scene"))
    }

    /// A scene's bytes, if they are there and whole.
    #[must_use]
    pub fn load(&self, hash: SceneHash) -> Option<Vec<u8>> {
        let path = self.path(hash);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
            Err(error) => {
                tracing::warn!("cannot read the cached scene {}: {error}", path.display());
                return None;
            }
        };
        if hash_of(&bytes) == hash {
            return Some(bytes);
        }
        tracing::warn!(
            "the cached scene {} is damaged: it is deleted and fetched again",
            path.display()
        );
        if let Err(error) = fs::remove_file(&path) {
            tracing::warn!("cannot delete {}: {error}", path.display());
        }
        None
    }

    /// Keeps a scene's bytes, all or nothing.
    ///
    /// # Errors
    /// What the disk says; the caller can go on without the entry.
    pub fn store(&self, hash: SceneHash, bytes: &[u8]) -> io::Result<()> {
        file::replace(&self.path(hash), bytes)
    }
}

fn make_private_directory(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        return Ok(());
    }
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stored_is_loaded_and_belongs_to_its_owner_alone() {
        let home = tempfile::tempdir().unwrap();
        let cache = SceneCache::open(home.path().join("a/lie")).unwrap();
        let (bytes, hash) = (b"scene".to_vec(), hash_of(b"scene"));
        assert_eq!(cache.load(hash), None);
        cache.store(hash, &bytes).unwrap();
        cache.store(hash, &bytes).unwrap();
        assert_eq!(cache.load(hash), Some(bytes));
        assert_eq!(fs::read_dir(home.path().join("a/lie")).unwrap().count(), 1);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
            assert_eq!(mode(&cache.path(hash)), 0o600);
            assert_eq!(mode(&home.path().join("a/lie")), 0o700);
        }
    }

    #[test]
    fn a_damaged_entry_is_deleted() {
        let home = tempfile::tempdir().unwrap();
        let cache = SceneCache::open(home.path()).unwrap();
        let hash = hash_of(b"scene");
        for damaged in [&b"scen"[..], b"", b"scenE", b"scene and more"] {
            fs::write(cache.path(hash), damaged).unwrap();
            assert_eq!(cache.load(hash), None);
            assert!(!cache.path(hash).exists());
        }
    }

    #[test]
    fn a_failed_store_leaves_nothing() {
        let home = tempfile::tempdir().unwrap();
        let cache = SceneCache::open(home.path().join("lie")).unwrap();
        fs::remove_dir(home.path().join("lie")).unwrap();
        assert!(cache.store(hash_of(b"scene"), b"scene").is_err());
        assert!(SceneCache::open("/proc/nothing/here").is_err());
    }
}
