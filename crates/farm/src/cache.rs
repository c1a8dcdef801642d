//! Scenes on the local disk, by the hash of their bytes.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::{Path, PathBuf},
};

use lie_protocol::{SceneHash, limit};

use crate::{file, scene_blob::hash_of};

/// A directory of scenes, one file each, named by the hash in hexadecimal: nothing else that
/// comes over the network becomes part of a path. Directory and files are their owner's alone.
///
/// An entry is hashed at every load: one that was cut short, tampered with or hit by a bad
/// disk is deleted, never used. Writers may race: the last rename wins, with equal bytes.
#[derive(Clone, Debug)]
pub struct SceneCache {
    directory: PathBuf,
}

impl SceneCache {
    /// Opens the directory, making it (for its owner alone) if it is not there. One that is there
    /// is closed to others if nothing but scenes is in it.
    ///
    /// # Errors
    /// If it cannot be made, is another user's, or others may use what else is in it.
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
        let bytes = match read(&path) {
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

/// A plain file's bytes. There may be a pipe in its place, or something without an end.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    let found = fs::symlink_metadata(path)?;
    if !found.is_file() || found.len() > limit::SCENE {
        return Err(io::Error::other("it is no scene's file"));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(found.len()).unwrap_or(0));
    File::open(path)?
        .take(limit::SCENE)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn make_private_directory(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        #[cfg(unix)]
        close_to_others(path)?;
        return Ok(());
    }
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Makes sure that a directory is ours alone.
#[cfg(unix)]
fn close_to_others(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let found = fs::metadata(path)?;
    let refuse = |why: &str| Err(io::Error::new(io::ErrorKind::PermissionDenied, why));
    if found.uid() != rustix::process::geteuid().as_raw() {
        return refuse("the folder belongs to another user");
    }
    if found.mode() & 0o077 == 0 {
        return Ok(());
    }
    // A folder that serves other purposes too is not for us to close.
    for entry in fs::read_dir(path)? {
        let name = entry?.file_name();
        if !name.as_encoded_bytes().ends_with(b".scene") {
            return refuse("others may use the folder, and more than scenes is in it");
        }
    }
    fs::set_permissions(path, fs::Permissions::from_mode(0o700))
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

    #[cfg(unix)]
    #[test]
    fn a_folder_that_others_may_use_is_closed_or_refused() {
        use std::os::unix::fs::PermissionsExt;
        let home = tempfile::tempdir().unwrap();
        let open_to_all = |path: &Path| {
            fs::create_dir_all(path).unwrap();
            fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
        };
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let (empty, shared) = (home.path().join("empty"), home.path().join("shared"));
        open_to_all(&empty);
        let cache = SceneCache::open(&empty).unwrap();
        assert_eq!(mode(&empty), 0o700);
        cache.store(hash_of(b"scene"), b"scene").unwrap();
        open_to_all(&empty);
        SceneCache::open(&empty).unwrap();
        assert_eq!(mode(&empty), 0o700);

        open_to_all(&shared);
        fs::write(shared.join("notes.txt"), b"").unwrap();
        let refused = SceneCache::open(&shared).unwrap_err();
        assert!(
            refused.to_string().contains("more than scenes"),
            "{refused}"
        );
        assert_eq!(mode(&shared), 0o777);
        if rustix::process::geteuid().is_root() {
            let foreign = home.path().join("foreign");
            open_to_all(&foreign);
            std::os::unix::fs::chown(&foreign, Some(12345), None).unwrap();
            let refused = SceneCache::open(&foreign).unwrap_err();
            assert!(refused.to_string().contains("another user"), "{refused}");
        }
    }

    #[test]
    fn every_hash_names_a_file_right_in_the_folder() {
        let home = tempfile::tempdir().unwrap();
        let cache = SceneCache::open(home.path()).unwrap();
        for byte in [0, b'.', b'/', b'\\', 0xff] {
            let path = cache.path(SceneHash([byte; 32]));
            assert_eq!(path.parent(), Some(home.path()));
            let name = path.file_stem().unwrap().to_str().unwrap();
            assert!(name.len() == 64 && name.bytes().all(|b| b.is_ascii_hexdigit()));
        }
    }

    #[test]
    fn what_is_no_file_is_left_alone() {
        let home = tempfile::tempdir().unwrap();
        let cache = SceneCache::open(home.path()).unwrap();
        let hash = hash_of(b"scene");
        fs::create_dir(cache.path(hash)).unwrap();
        assert_eq!(cache.load(hash), None);
        #[cfg(unix)]
        {
            fs::remove_dir(cache.path(hash)).unwrap();
            std::os::unix::fs::symlink("/dev/zero", cache.path(hash)).unwrap();
            assert_eq!(cache.load(hash), None);
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
