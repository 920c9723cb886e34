//! A chain in a tree of links: URDF or MJCF, distinguished by the first element.

use armid::model::format::{ChainEnds, ImportedModel, parse_mjcf, parse_urdf};

use crate::error::Error;
use crate::text::Text;

/// The chain of a tree in XML.
pub(super) fn parse(text: &Text, chain: &ChainEnds) -> Result<ImportedModel, Error> {
    let parse = if is_mjcf(&text.content) { parse_mjcf } else { parse_urdf };
    parse(&text.content, chain).map_err(|error| Error::of_format(text, &error))
}

/// Is the first element, past declarations and comments, MuJoCo's?
pub(super) fn is_mjcf(text: &str) -> bool {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = if rest.starts_with("<!--") {
            "-->"
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            ">"
        } else {
            return rest.starts_with("<mujoco");
        };
        let Some(at) = rest.find(end) else { return false };
        rest = rest[at + end.len()..].trim_start();
    }
}

#[cfg(test)]
mod tests {
    use super::is_mjcf;

    #[test]
    fn the_first_element_decides() {
        assert!(is_mjcf("<mujoco model=\"arm\"/>"));
        assert!(is_mjcf("\u{feff}<?xml version=\"1.0\"?>\n<!-- <robot> -->\n<mujoco/>"));
        assert!(!is_mjcf("<?xml version=\"1.0\"?><!-- <mujoco> --><robot name=\"arm\"/>"));
        assert!(!is_mjcf("<!-- never closed <mujoco>"));
    }
}
