//! Text files, read up to a greatest size: a device without end must not fill the memory.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::OnceLock;

/// Greatest size of a TOML or JSON file [bytes]; real ones are far smaller.
pub const LARGEST_TOML: u64 = 1 << 20;

/// Greatest size of a G-code file [bytes].
pub const LARGEST_GCODE: u64 = 64 << 20;

/// The path that stands for the standard input.
pub const STANDARD_INPUT: &str = "-";

/// Reads a file of at most `limit` bytes, or the standard input if the path is `-`. Devices and FIFOs
/// are read, too, up to the limit.
pub fn read_bytes(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    if path == Path::new(STANDARD_INPUT) {
        return read_standard_input(limit);
    }
    read_stream(open_file(path, limit)?, limit)
}

/// Opens a file of at most `limit` bytes, or the standard input if the path is `-`, to read it piece by piece.
/// A device or a FIFO ends at the limit with an error.
pub fn open(path: &Path, limit: u64) -> io::Result<Box<dyn Read>> {
    if path == Path::new(STANDARD_INPUT) {
        return Ok(Box::new(io::Cursor::new(read_standard_input(limit)?)));
    }
    let left = limit;
    let stream = open_file(path, limit)?;
    Ok(Box::new(Limited {
        stream,
        limit,
        left,
    }))
}

fn open_file(path: &Path, limit: u64) -> io::Result<File> {
    let file = File::open(path)?;
    // Of a device or a FIFO, the size is 0.
    let size = file.metadata()?.len();
    if size > limit {
        return Err(too_large(format_args!("it has {size} bytes"), limit));
    }
    Ok(file)
}

/// A stream that must end within a limit.
struct Limited {
    stream: File,
    limit: u64,
    left: u64,
}

impl Read for Limited {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.stream.read(buffer)?;
        let left = self.left.checked_sub(count as u64);
        self.left =
            left.ok_or_else(|| too_large(format_args!("it goes on after that"), self.limit))?;
        Ok(count)
    }
}

/// Reads the standard input to its end. A command may read its files more than once, so the bytes are kept.
fn read_standard_input(limit: u64) -> io::Result<Vec<u8>> {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    if let Some(bytes) = BYTES.get() {
        return Ok(bytes.clone());
    }
    let bytes = read_stream(io::stdin(), limit)?;
    Ok(BYTES.get_or_init(|| bytes).clone())
}

/// Reads a stream to its end, at most `limit` bytes.
pub fn read_stream(stream: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(format_args!("it goes on after that"), limit));
    }
    Ok(bytes)
}

/// Reads a file of text, of at most `limit` bytes.
pub fn read_text(path: &Path, limit: u64) -> io::Result<String> {
    String::from_utf8(read_bytes(path, limit)?).map_err(|_| {
        let reason = "stream did not contain valid UTF-8";
        io::Error::new(io::ErrorKind::InvalidData, reason)
    })
}

fn too_large(how: std::fmt::Arguments<'_>, limit: u64) -> io::Error {
    let reason = format!("at most {limit} bytes are read, and {how}");
    io::Error::new(io::ErrorKind::FileTooLarge, reason)
}

#[cfg(test)]
mod tests {
    use super::{read_bytes, read_text};
    use std::path::Path;

    #[test]
    fn a_file_larger_than_the_limit_is_refused_with_both_sizes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read_text(&path, 5).unwrap(), "12345");
        let error = read_text(&path, 4).unwrap_err().to_string();
        assert_eq!(error, "at most 4 bytes are read, and it has 5 bytes");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_without_end_is_refused_at_the_limit() {
        let error = read_bytes(Path::new("/dev/zero"), 1000).unwrap_err();
        let reason = "at most 1000 bytes are read, and it goes on after that";
        assert_eq!(error.to_string(), reason);
    }
}
