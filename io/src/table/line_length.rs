//! How long a line of a table may be.

use armid::input::size::LINE_BYTES;

use crate::error::Error;
use crate::text::Text;

/// No line is longer than a table's can be, before any is taken apart.
pub(super) fn check_lines(text: &Text) -> Result<(), Error> {
    let mut start = 0;
    for line in text.content.split_inclusive('\n') {
        LINE_BYTES
            .check_count("length of the line", line.len())
            .map_err(|error| Error::from(error).at_span(text, start..start, "this line"))?;
        start += line.len();
    }
    Ok(())
}
