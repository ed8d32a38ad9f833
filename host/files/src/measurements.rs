//! Tables of measurements: comma-separated values with a header line. Columns are found by
//! their names; others are ignored.

use super::source::FileError;
use super::text_file::open;
use crate::budget::Budget;
use std::cell::Cell;
use std::io::{self, Read};
use std::path::Path;

/// Greatest size of a table [bytes]: ten minutes of a log of eight columns at 10 kHz.
const LARGEST: u64 = 1 << 29;
/// Longest row [bytes], with line ends within quotation marks: the reader keeps one in memory.
const LONGEST_ROW: usize = 1 << 20;

/// The rows of a table, each with the values of these columns.
///
/// # Errors
/// A file that cannot be read, a column that is missing or stands twice, and a value that is not
/// a finite number, with its line.
pub fn read_columns<const N: usize>(
    path: &Path,
    columns: [&str; N],
) -> Result<Vec<[f64; N]>, FileError> {
    let file = path.display().to_string();
    let stream = open(path, LARGEST).map_err(|error| FileError::new(&file, error))?;
    parse_columns(&file, stream, columns)
}

/// A stream that ends with an error in a row that is too long.
struct Rows<'a, R> {
    stream: R,
    /// The bytes that were read since the last row was complete.
    length: &'a Cell<usize>,
}

impl<R: Read> Read for Rows<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.stream.read(buffer)?;
        self.length.set(self.length.get() + count);
        if self.length.get() > LONGEST_ROW {
            let reason = format!("a row has more than {LONGEST_ROW} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        Ok(count)
    }
}

/// The rows of a table that is read piece by piece; errors name the file.
///
/// # Errors
/// As [`read_columns`].
pub fn parse_columns<const N: usize>(
    file: &str,
    stream: impl Read,
    columns: [&str; N],
) -> Result<Vec<[f64; N]>, FileError> {
    let length = Cell::new(0);
    let mut reader = csv::Reader::from_reader(Rows {
        stream,
        length: &length,
    });
    let refuse = |line: Option<u64>, reason: String| FileError {
        line: line.map(|line| line as usize),
        ..FileError::new(file, reason)
    };
    let broken = |error: csv::Error| {
        let line = error.position().map(csv::Position::line);
        if let csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } = error.kind()
        {
            let reason = format!("it has {len} values, the header {expected_len}");
            return refuse(line, reason);
        }
        refuse(
            line,
            format!("it is no table of comma-separated values: {error}"),
        )
    };
    let header = reader.byte_headers().map_err(broken)?.clone();
    let name_of = |index: usize| {
        let name = &header[index];
        // The byte order mark of UTF-8.
        name.strip_prefix(b"\xef\xbb\xbf")
            .unwrap_or(name)
            .trim_ascii()
    };
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(columns) {
        let found: Vec<usize> = (0..header.len())
            .filter(|&index| name_of(index) == name.as_bytes())
            .collect();
        *place = match found[..] {
            [index] => index,
            [] => {
                let wanted = columns.join(",");
                let reason = format!("no column `{name}`; the header must name {wanted}");
                return Err(refuse(Some(1), reason));
            }
            _ => return Err(refuse(Some(1), format!("the column `{name}` stands twice"))),
        };
    }
    let mut rows = Vec::new();
    let mut budget = Budget::values();
    let mut record = csv::ByteRecord::new();
    while reader.read_byte_record(&mut record).map_err(broken)? {
        length.set(0);
        budget
            .take(N)
            .map_err(|over| refuse(None, over.to_string()))?;
        let mut row = [0.0; N];
        for ((value, &place), name) in row.iter_mut().zip(&places).zip(columns) {
            let text = String::from_utf8_lossy(record[place].trim_ascii());
            *value = text
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| {
                    let line = record.position().map(csv::Position::line);
                    refuse(
                        line,
                        format!("`{name}` must be a finite number, not `{text}`"),
                    )
                })?;
        }
        rows.push(row);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::parse_columns;

    #[test]
    fn columns_are_found_by_name_and_bad_values_by_line() {
        let read = |text: &str| parse_columns("t.csv", text.as_bytes(), ["a", "b"]);
        let table = "\u{feff}b, note,a\r\n1.5,x,-2\r\n\r\n3,y,4e-3\r\n";
        assert_eq!(read(table).unwrap(), [[-2.0, 1.5], [4e-3, 3.0]]);
        assert!(read("a,b\n").unwrap().is_empty());
        for (text, wanted) in [
            ("a\n1\n", "line 1: no column `b`"),
            ("a,b,a\n1,2,3\n", "line 1: the column `a` stands twice"),
            (
                "a,b\n1,2\n1,nan\n",
                "line 3: `b` must be a finite number, not `nan`",
            ),
            ("a,b\n1,2\n1\n", "line 3: it has 1 values, the header 2"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(wanted), "{error}");
        }
    }
}
