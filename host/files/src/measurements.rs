//! Tables of measurements: comma-separated values with a header line. Columns are found by
//! their names; others are ignored.

use super::source::FileError;
use super::text_file::read_bytes;
use std::path::Path;

/// Greatest size of a table [bytes]: ten minutes of a log at 10 kHz.
const LARGEST: u64 = 1 << 30;

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
    let bytes = read_bytes(path, LARGEST).map_err(|error| FileError::new(&file, error))?;
    parse_columns(&file, &bytes, columns)
}

fn parse_columns<const N: usize>(
    file: &str,
    bytes: &[u8],
    columns: [&str; N],
) -> Result<Vec<[f64; N]>, FileError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(bytes);
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
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(columns) {
        let found: Vec<usize> = (0..header.len())
            .filter(|&index| &header[index] == name.as_bytes())
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
    let mut record = csv::ByteRecord::new();
    while reader.read_byte_record(&mut record).map_err(broken)? {
        let mut row = [0.0; N];
        for ((value, &place), name) in row.iter_mut().zip(&places).zip(columns) {
            let text = String::from_utf8_lossy(&record[place]);
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
