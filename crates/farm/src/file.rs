//! Files that belong to their owner alone and are written all or nothing.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Write},
    path::Path,
};

/// Puts bytes into a file: by another one beside it, so that readers, and whoever comes after a
/// crash, find the old content or the new.
///
/// # Errors
/// What the disk says; the file is then as it was.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().ok_or(io::ErrorKind::InvalidFilename)?);
    name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(name);
    // One may be left of a process that was killed and had the same number.
    match fs::remove_file(&temporary) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let written = write_private(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // Nothing more can be done about the part; what matters is the first error.
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Makes a file that is not there yet.
///
/// # Errors
/// What the disk says, [`io::ErrorKind::AlreadyExists`] for instance; there is no file then that
/// was not there before.
pub(crate) fn create(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let written = write_private(path, bytes);
    if let Err(error) = &written
        && error.kind() != io::ErrorKind::AlreadyExists
    {
        // What matters is the first error.
        let _ = fs::remove_file(path);
    }
    written
}

/// Writes a file of which nobody else can have made anything before, a link for instance.
fn write_private(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file: File = options.open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_is_only_replaced_when_it_shall_be() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("file");
        create(&path, b"old").unwrap();
        let error = create(&path, b"new").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        replace(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
        assert!(create(&home.path().join("none/file"), b"").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_way_leads_nowhere_and_the_file_is_its_owners() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let home = tempfile::tempdir().unwrap();
        let victim = home.path().join("victim");
        fs::write(&victim, b"precious").unwrap();
        let part = format!(".file.{}.part", std::process::id());
        symlink(&victim, home.path().join(part)).unwrap();
        let path = home.path().join("file");
        replace(&path, b"new").unwrap();
        assert_eq!(fs::read(&victim).unwrap(), b"precious");
        let mode = fs::symlink_metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}
