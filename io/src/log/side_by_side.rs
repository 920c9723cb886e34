//! Which of several files make one log: by a `*` in the names that a mapping gives them, and the `[log]` tables that say it at length.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting};

use super::foreign_csv;
use super::mapping::Mapping;
use crate::error::Error;

/// What stands for the part of a name that the files of one log share.
const STAR: char = '*';

/// The logs that files make, each with the mapping of its files: one, or where the mapping names files with a `*`, one for each text that
/// it stands for.
///
/// # Errors
/// [`Error`] where a file has none of the names, or a log lacks one of its files.
pub(super) fn logs(mapping: &Mapping, paths: &[PathBuf]) -> Result<Vec<(Mapping, Vec<PathBuf>)>, Error> {
    let names = names(mapping);
    if !names.iter().any(|name| name.contains(STAR)) {
        return Ok(vec![(mapping.clone(), paths.to_vec())]);
    }
    let logs = grouped(&names, paths).map_err(|path| {
        let message = format!("{} is none of {}, the files of the mapping", path.display(), names.join(", "));
        Error::unknown(message).help("* stands for what the names of the files of one log have in common")
    })?;
    for (shared, files) in &logs {
        if files.len() != names.len() {
            let named: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            let expected: Vec<String> = names.iter().map(|name| name.replace(STAR, shared)).collect();
            let message = format!("found {} of one log, expected {}", named.join(", "), expected.join(", "));
            return Err(Error::mismatch(message));
        }
    }
    let of = |(shared, files): (String, Vec<PathBuf>)| (renamed(mapping, |name| name.replace(STAR, &shared)), files);
    Ok(logs.into_iter().map(of).collect())
}

/// What helps where one mapping is not that of all files: the `[log]` tables of the logs that their names suggest, and the mapping that says
/// the same. `None` where the files may be those of one log.
pub(super) fn several(mapping: &Mapping, paths: &[PathBuf]) -> Option<Remedy> {
    let names = names(mapping);
    let (starred, logs) = match guessed(&names, paths) {
        Some((starred, logs)) => (Some(starred), logs),
        None if paths.len() <= names.len() => return None,
        None => (None, paths.chunks(names.len().max(1)).map(<[PathBuf]>::to_vec).collect()),
    };
    let mut text =
        "of several logs, each has a file that says what its columns are, and is named in place of its data:\n"
            .to_owned();
    for files in &logs {
        let own = renamed(mapping, |name| {
            let at = names.iter().position(|known| *known == name).unwrap_or(0);
            let by_name =
                files.iter().find(|file| starred.as_ref().is_some_and(|all| shared(file, &all[at]).is_some()));
            by_name.or(files.get(at)).map_or_else(|| name.to_owned(), |file| stem(file))
        });
        text += &toml(&own, files);
    }
    let help = Remedy::from(text);
    Some(if let Some(starred) = starred {
        let own = renamed(mapping, |name| {
            names.iter().position(|known| *known == name).map_or_else(|| name.to_owned(), |at| starred[at].clone())
        });
        help.say("\nor, for all of them: ").assign(Setting::Map, own.text())
    } else {
        help
    })
}

/// What helps where the mapping of other logs does not fit one.
pub(super) fn another(mapping: &Mapping, path: &Path) -> String {
    format!(
        "where this log has other columns than those beside it, a file says what they are, and is named in place of it:\n{}",
        toml(mapping, &[path.to_path_buf()])
    )
}

/// A `[log]` table, with the name that it may have.
fn toml(mapping: &Mapping, files: &[PathBuf]) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let names: Vec<String> = files
        .iter()
        .map(|file| quoted(&file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()))
        .collect();
    let beside = files.first().map(|file| file.with_extension("toml").display().to_string()).unwrap_or_default();
    let mut text = format!("\n# {beside}\n[log]\nfiles = [{}]\n", names.join(", "));
    for map in &mapping.columns {
        let _ = writeln!(text, "{} = {}", map.quantity.key(), quoted(&map.text()));
    }
    text
}

/// The files that a mapping names, each once.
fn names(mapping: &Mapping) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in mapping.columns.iter().filter_map(|map| map.file.as_deref()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The mapping with other names of its files.
fn renamed(mapping: &Mapping, name: impl Fn(&str) -> String) -> Mapping {
    let mut mapping = mapping.clone();
    for map in &mut mapping.columns {
        map.file = map.file.as_deref().map(&name);
    }
    mapping
}

/// The files by what the `*` of one of these names stands for in theirs, in their order.
///
/// # Errors
/// The file that has none of the names.
fn grouped<'a>(names: &[impl AsRef<str>], paths: &'a [PathBuf]) -> Result<Vec<(String, Vec<PathBuf>)>, &'a Path> {
    let mut logs: Vec<(String, Vec<PathBuf>)> = Vec::new();
    for path in paths {
        let shared = names.iter().find_map(|name| shared(path, name.as_ref())).ok_or(path.as_path())?;
        match logs.iter_mut().find(|(known, _)| *known == shared) {
            Some((_, files)) => files.push(path.clone()),
            None => logs.push((shared, vec![path.clone()])),
        }
    }
    Ok(logs)
}

/// What the `*` of a name stands for in that of a file, with or without its ending.
fn shared(path: &Path, name: &str) -> Option<String> {
    let (front, back) = name.split_once(STAR)?;
    let whole = path.file_name()?.to_string_lossy().into_owned();
    let between = |text: &str| text.strip_prefix(front)?.strip_suffix(back).map(str::to_owned);
    between(&stem(path)).or_else(|| between(&whole))
}

fn stem(path: &Path) -> String {
    foreign_csv::stem(&path.to_string_lossy()).to_owned()
}

/// The names with a `*` in the place of the begin or the end that they have in common, if that makes whole logs of all files.
fn guessed(names: &[&str], paths: &[PathBuf]) -> Option<(Vec<String>, Vec<Vec<PathBuf>>)> {
    let stems: Vec<String> = names.iter().map(|name| stem(Path::new(name))).collect();
    let first = stems.first().filter(|_| stems.len() > 1)?;
    let places = || first.char_indices().map(|(at, _)| at).skip(1);
    // A part that they have in common begins or ends at a sign between words, where there is one in it.
    let sign = |text: &str, from_back: bool| {
        let is_sign = |c: char| !c.is_alphanumeric();
        if from_back {
            text.rfind(is_sign)
        } else {
            text.find(is_sign).map(|at| at + text[at..].chars().next().map_or(0, char::len_utf8))
        }
    };
    let back = places().find(|&at| stems.iter().all(|stem| stem.ends_with(&first[at..])));
    let back = back.map(|at| first.len() - at - sign(&first[at..], false).unwrap_or(0));
    let front = places().filter(|&at| stems.iter().all(|stem| stem.starts_with(&first[..at]))).last();
    let front = front.map(|at| sign(&first[..at], true).unwrap_or(at));
    let starred = [
        back.map(|length| stems.iter().map(|stem| format!("{}*", &stem[..stem.len() - length])).collect::<Vec<_>>()),
        front.map(|length| stems.iter().map(|stem| format!("*{}", &stem[length..])).collect()),
    ];
    starred.into_iter().flatten().find_map(|starred| {
        let is_name = |name: &String| name.len() > 1;
        let logs = grouped(&starred, paths).ok()?;
        let whole = starred.iter().all(is_name) && logs.iter().all(|(_, files)| files.len() == names.len());
        whole.then(|| (starred, logs.into_iter().map(|(_, files)| files).collect()))
    })
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::{another, logs, several};
    use crate::log::Mapping;
    use crate::log::log_file::LogFile;
    use crate::text::Text;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn a_star_is_what_the_files_of_one_log_share() {
        let mapping = Mapping::parse("q=q_*:j[1-6], tau=tau_*:j[1-6]").unwrap();
        let found = logs(&mapping, &paths(&["d/q_a.csv", "d/tau_a.csv", "d/tau_b.csv.gz", "d/q_b.csv"])).unwrap();
        let texts: Vec<String> = found.iter().map(|(mapping, _)| mapping.text()).collect();
        assert_eq!(texts, ["q=q_a:j[1-6], tau=tau_a:j[1-6]", "q=q_b:j[1-6], tau=tau_b:j[1-6]"]);
        assert_eq!(found[1].1, paths(&["d/tau_b.csv.gz", "d/q_b.csv"]));
        let fault = logs(&mapping, &paths(&["q_a.csv", "tau_b.csv"])).unwrap_err().to_string();
        assert_eq!(fault, "found q_a.csv of one log, expected q_a, tau_a");
        let fault = logs(&mapping, &paths(&["x.csv"])).unwrap_err().to_string();
        assert_eq!(fault, "x.csv is none of q_*, tau_*, the files of the mapping");
    }

    #[test]
    fn the_tables_that_are_proposed_can_be_pasted() {
        let mapping = Mapping::parse("q=q_a:j[1-6] deg, tau=tau_a:j[1-6]").unwrap();
        let help =
            several(&mapping, &paths(&["d/q_a.csv", "d/tau_a.csv", "d/q_b.csv", "d/tau_b.csv"])).unwrap().to_string();
        let wanted = "\n# d/q_b.toml\n[log]\nfiles = [\"q_b.csv\", \"tau_b.csv\"]\nq = \"q_b:j[1-6] deg\"\ntau = \"tau_b:j[1-6]\"\n";
        assert!(help.contains(wanted), "{help}");
        assert!(help.ends_with("map \"q=q_*:j[1-6] deg, tau=tau_*:j[1-6]\""), "{help}");
        let file = LogFile::parse(&Text::new("d/q_b.toml", wanted), Path::new("d")).unwrap();
        assert_eq!(file.files, paths(&["d/q_b.csv", "d/tau_b.csv"]));
        // The part in front, and names that say nothing.
        let mapping = Mapping::parse("q=a-pos:#[1-2], tau=a-cur:#[1-2]").unwrap();
        let help =
            several(&mapping, &paths(&["a-pos.txt", "a-cur.txt", "b-cur.txt", "b-pos.txt"])).unwrap().to_string();
        assert!(help.ends_with("map \"q=*-pos:#[1-2], tau=*-cur:#[1-2]\""), "{help}");
        let mapping = Mapping::parse("q=x:#[1-2], tau=y:#[1-2]").unwrap();
        let help = several(&mapping, &paths(&["x.txt", "y.txt", "v.txt", "w.txt"])).unwrap().to_string();
        assert!(help.contains("files = [\"v.txt\", \"w.txt\"]\nq = \"v:#[1-2]\"\ntau = \"w:#[1-2]\"\n"), "{help}");
        // Those of another log alone, and a slip.
        let mapping = Mapping::parse("q=q_a:j[1-6], tau=tau_a:j[1-6]").unwrap();
        let help = several(&mapping, &paths(&["q_b.csv", "tau_b.csv"])).unwrap().to_string();
        assert!(help.contains("q = \"q_b:j[1-6]\""), "{help}");
        let mapping = Mapping::parse("q=pso:j[1-6], tau=cur:j[1-6]").unwrap();
        assert_eq!(several(&mapping, &paths(&["pos.csv", "cur.csv"])), None);
        let help = another(&Mapping::parse("q=x[1-2], tau=y[1-2]").unwrap(), Path::new("b.csv"));
        assert!(help.ends_with("# b.toml\n[log]\nfiles = [\"b.csv\"]\nq = \"x[1-2]\"\ntau = \"y[1-2]\"\n"), "{help}");
    }
}
