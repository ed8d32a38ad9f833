//! Tables of comma-separated values in memory.

/// A table that is written row by row.
pub(super) struct Table(csv::Writer<Vec<u8>>);

const IN_MEMORY: &str = "writing to memory cannot fail, and all rows have the header's length";

impl Table {
    /// A table without rows.
    pub(super) fn new<T: AsRef<[u8]>>(header: impl IntoIterator<Item = T>) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.push(header);
        table
    }

    /// Adds a row, which must have the length of the header.
    pub(super) fn push<T: AsRef<[u8]>>(&mut self, row: impl IntoIterator<Item = T>) {
        self.0.write_record(row).expect(IN_MEMORY);
    }

    /// The table as text.
    pub(super) fn into_text(self) -> String {
        let bytes = self.0.into_inner().expect(IN_MEMORY);
        String::from_utf8(bytes).expect("the cells are UTF-8")
    }
}
