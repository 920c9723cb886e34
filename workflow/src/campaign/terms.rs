//! Terms that the logs show, and the columns of a campaign do not have yet.

use std::path::Path;

use armid::base::{Category, Method, reduce};
use armid::estimation::candidate_terms;
use armid::model::term::Term;
use armid::model::{Columns, distinct};
use armid::observer::Observer;
use armid::seed::Seed;
use armid_io::output::write_text;
use armid_io::{Error, ErrorKind, LoadedRobot, ProcessedLog};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::logs::estimate;

/// What keeps the columns of all estimates, once terms were selected.
pub(super) const COLUMNS: &str = "columns.toml";

/// Scaled condition number up to which a round shows its parameters. The mean of rounds needs the inverse of its square.
const SHOWN: f64 = 1e6;

/// A selection of terms, as `columns.toml` keeps it. It is written before any estimate with its columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SelectedColumns {
    /// Finished rounds when terms were selected last.
    pub(super) after: usize,
    /// The columns of all estimates.
    #[serde(serialize_with = "as_text", deserialize_with = "estimable")]
    pub(super) columns: Columns,
}

fn as_text<S: Serializer>(columns: &Columns, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(columns)
}

fn estimable<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Columns, D::Error> {
    Columns::parse_estimable(&String::deserialize(deserializer)?).map_err(D::Error::custom)
}

impl SelectedColumns {
    /// Writes it into the folder of a campaign.
    pub(super) fn write(&self, folder: &Path) -> Result<(), Error> {
        write_text(&folder.join(COLUMNS), &toml::to_string(self).map_err(Error::new)?)
    }
}

/// These columns with the terms that are selected by the log of all rounds, as `armid identify --select` does. Each round must show a term
/// too, since each has an estimate of its own.
///
/// # Errors
/// [`Error`] where the log shows not even the links; of [`armid_io::ErrorKind::Interrupted`] where the observer ended the selection.
pub(super) fn extended(
    loaded: &LoadedRobot,
    columns: Columns,
    mut all: ProcessedLog,
    rounds: &[&ProcessedLog],
    observer: &dyn Observer,
) -> Result<Columns, Error> {
    // A soft onset of friction is no other term.
    all.find_onset(Columns::RIGID_ROTOR_FRICTION, observer)?;
    let candidates = candidate_terms().into_iter().fold(Columns::RIGID, Columns::with_term);
    let selected = Columns::parse_estimable(&all.select_watched(candidates, observer)?.columns).map_err(Error::new)?;
    let mut extended = columns;
    for word in distinct(selected.terms().filter(|term| !columns.has(*term)).map(|term| term.entry().name)) {
        let terms = Term::ALL.iter().copied().filter(|term| term.entry().name == word);
        let wider = terms.fold(extended, Columns::with_term);
        if keeps_base(loaded, columns, wider)? && do_all_show(rounds, wider, observer)? {
            extended = wider;
        }
    }
    Ok(extended)
}

/// Whether each round by itself shows the parameters of the columns.
fn do_all_show(rounds: &[&ProcessedLog], columns: Columns, observer: &dyn Observer) -> Result<bool, Error> {
    for log in rounds {
        match estimate(log, columns, false, observer) {
            Ok(of) if of.condition_scaled <= SHOWN => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => return Err(error),
            Ok(_) | Err(_) => return Ok(false),
        }
    }
    Ok(true)
}

/// Whether all base parameters of the columns stay what they are in wider ones, since targets name them, and designs have such columns.
fn keeps_base(loaded: &LoadedRobot, columns: Columns, wider: Columns) -> Result<bool, Error> {
    if wider.beyond_motion().is_some() && loaded.guess().is_none() {
        return Ok(false);
    }
    let base = reduce(&loaded.robot, wider, Method::Structural, Seed::new(0)).map_err(Error::new)?;
    let is_new = |place: usize| base.parameters[place].kind.term().is_some_and(|term| !columns.has(term));
    let is_apart = |category: Category| matches!(category, Category::Identifiable | Category::Unidentifiable);
    Ok((0..base.parameters.len()).filter(|place| is_new(*place)).all(|place| is_apart(base.categories[place])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_nobody_knows_are_named_with_their_line() {
        let read = |columns: &str| toml::from_str::<SelectedColumns>(&format!("after = 2\ncolumns = \"{columns}\""));
        let known = read("rigid+friction").unwrap();
        assert_eq!((known.after, known.columns.to_string()), (2, "rigid+friction".to_owned()));
        let fault = read("rigid+fiction").unwrap_err();
        assert!(fault.to_string().contains("line 2") && fault.message().contains("fiction"), "{fault}");
    }
}
