//! Files that appear complete or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::IoError;

/// A file written beside its final name, not yet visible under it. Dropped, it is gone.
pub struct Draft {
    file: NamedTempFile,
    path: PathBuf,
    target: PathBuf,
}

impl Draft {
    /// Opens a draft of `path` in its directory.
    ///
    /// # Errors
    /// [`IoError::Write`] if the directory does not exist or may not be written to, or `path` is
    /// something other than an ordinary file.
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let fail = IoError::write(path);
        let open = || {
            // Writing through a symbolic link changes what it points to, as it would without a draft.
            let target = if path.exists() { fs::canonicalize(path)? } else { path.to_owned() };
            match fs::metadata(&target) {
                Ok(data) if data.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
                Ok(data) if !data.is_file() => return Err(io::Error::other("not an ordinary file")),
                _ => {}
            }
            let directory = match target.parent() {
                Some(directory) if directory != Path::new("") => directory,
                _ => Path::new("."),
            };
            let mut builder = tempfile::Builder::new();
            builder.prefix(".formwork-").suffix(".part");
            // The temporary file becomes the result, so it has the permissions of any new file.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            Ok(Draft { file: builder.tempfile_in(directory)?, path: path.to_owned(), target })
        };
        open().map_err(fail)
    }

    /// Fills the draft.
    ///
    /// # Errors
    /// [`IoError::Write`] if `contents` fails or the disk is full.
    pub fn write(
        &mut self,
        contents: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
    ) -> Result<(), IoError> {
        let mut out = BufWriter::new(self.file.as_file_mut());
        contents(&mut out).and_then(|()| out.flush()).map_err(IoError::write(&self.path))
    }

    /// Moves the draft to its final name, replacing what was there.
    ///
    /// # Errors
    /// [`IoError::Write`].
    pub fn publish(self) -> Result<(), IoError> {
        let moved = self.file.persist(&self.target);
        moved.map(|_| ()).map_err(|error| IoError::write(&self.path)(error.error))
    }
}

/// Writes a file in one go.
///
/// # Errors
/// [`IoError::Write`]; `path` is then as it was before.
pub fn write(
    path: &Path,
    contents: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), IoError> {
    let mut draft = Draft::open(path)?;
    draft.write(contents)?;
    draft.publish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        write(&path, |out| out.write_all(b"old")).unwrap();
        let result = write(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("stop"))
        });
        assert!(result.unwrap_err().to_string().contains("a.txt: cannot be written (stop)"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(directory.path()), ["a.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_are_ordinary() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let directory = tempfile::tempdir().unwrap();
        let at = |name| directory.path().join(name);
        File::create(at("ordinary")).unwrap();
        write(&at("target"), |out| out.write_all(b"1")).unwrap();
        symlink(at("target"), at("link")).unwrap();
        write(&at("link"), |out| out.write_all(b"2")).unwrap();
        assert_eq!(fs::read(at("target")).unwrap(), b"2");
        assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
        let mode = |name| fs::metadata(at(name)).unwrap().permissions().mode();
        assert_eq!(mode("target"), mode("ordinary"));
    }
}
