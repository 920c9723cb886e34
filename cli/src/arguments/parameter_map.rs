//! Files that map parameter names to values.

use std::path::Path;

use armid::model::format::parse_parameter_map;
use armid::model::{Robot, StandardParameters};
use armid_io::{Error, Text};

/// Reads one, TOML or JSON, and the robot with the laws of friction that it states; parameters that it leaves out are zero.
pub(crate) fn read_parameter_map(path: &Path, robot: &Robot) -> Result<(StandardParameters, Robot), Error> {
    let text = Text::read(path)?;
    parse_parameter_map(&text.content, robot).map_err(|error| Error::of_format(&text, &error))
}
