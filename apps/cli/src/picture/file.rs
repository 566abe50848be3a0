//! Files that appear complete or not at all.

use anyhow::{Context, Result};
use std::{io::Write, path::Path};

fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tresses-").suffix(".part");
    #[cfg(unix)]
    {
        // Temporary files are private by default; these become the user's, under the umask.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Fails when no file can be made in `folder`.
pub fn probe(folder: &Path) -> Result<()> {
    temporary(folder).map(drop).with_context(|| format!("{}: no file can be made there", folder.display()))
}

/// Writes `bytes` to `path`, replacing what is there.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let attempt = || {
        let mut file = temporary(path.parent().unwrap_or(Path::new("")))?;
        file.write_all(bytes)?;
        file.flush()?;
        file.persist(path).map_err(|error| error.error)
    };
    attempt().map(drop).with_context(|| path.display().to_string())
}
