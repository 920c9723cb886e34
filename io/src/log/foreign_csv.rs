//! Tables that something else wrote: one file, or several side by side, by a mapping or by their own headings.

use armid::remedy::{Remedy, Setting};

use super::Log;
use super::conversion::Conversion;
use super::mapping::{ColumnMap, Mapping, Quantity, Unit, listed};
use super::origin::{FileHash, Origin, ReadAs};
use super::raw_log::RawLog;
use super::servo;
use crate::error::Error;
use crate::suggestion;
use crate::table::LogTable;
use crate::text::Text;

/// Columns of one quantity in one table.
struct Found {
    quantity: Quantity,
    table: usize,
    /// One for each joint; `None` where the mapping leaves it out.
    columns: Vec<Option<usize>>,
    map: ColumnMap,
    unit: Unit,
}

/// Reads a log from the texts of its files, whose rows stand side by side. Without a mapping the headings say what the
/// columns are: `t` or `time`, `q1..qn`, `tau1..taun` or `current1..currentn`, `qd1..qdn`, each with its unit at the end
/// where it is not SI (`time_ms`, `q1_deg`). `rate_hz` takes the place of stamps.
///
/// # Errors
/// [`Error`] with line and column where a table is not as the mapping says.
pub fn parse(texts: Vec<Text>, mapping: Option<&Mapping>, rate_hz: Option<f64>) -> Result<Log, Error> {
    of_tables(texts.into_iter().map(LogTable::of_text).collect::<Result<_, _>>()?, mapping, rate_hz)
}

/// Reads the columns of a table of any kind.
///
/// # Errors
/// As [`parse`].
pub(super) fn of_tables(tables: Vec<LogTable>, mapping: Option<&Mapping>, rate_hz: Option<f64>) -> Result<Log, Error> {
    let hash = |table: &LogTable| FileHash { path: table.name().to_owned(), sha256: table.sha256() };
    let files = tables.iter().map(hash).collect();
    let Some(first) = tables.first() else { return Err(Error::new("no file is named, expected at least one")) };
    if let Some(rate) = rate_hz
        && !(rate.is_finite() && rate > 0.0)
    {
        return Err(Error::new(format!("the rate is {rate} Hz, expected a number above zero")));
    }
    if let Some((other, [own, found])) = tables.iter().find_map(|table| {
        let rows = [first.rows()?, table.rows()?];
        (rows[0] != rows[1]).then_some((table, rows))
    }) {
        let message =
            format!("{} has {own} rows and {} has {found}, expected as many side by side", first.name(), other.name(),);
        return Err(Error::mismatch(message));
    }
    if let Some(topic) = mapping.and_then(|mapping| mapping.topic.as_deref()) {
        let message = format!("{} is a table, found topic={topic}, expected columns alone", first.name());
        return Err(Error::mismatch(message).help("a topic is one of joint states of ROS 2: leave it out"));
    }
    let found = match mapping {
        Some(mapping) => by_mapping(&tables, mapping, rate_hz.is_some())?,
        None => by_headings(&tables, rate_hz.is_some())?,
    };
    let is_read = |k: &usize| found.iter().any(|found| found.table == *k);
    if let Some(aside) = (0..tables.len()).find(|k| !is_read(k)) {
        let message = format!("nothing is read from {}, expected columns of every file", tables[aside].name());
        return Err(Error::mismatch(message).help("name its columns, as file:heading, or leave the file out"));
    }
    let raw = Reader { tables: &tables, found, rate_hz }.read(files)?;
    let time = tables
        .iter()
        .position(|table| table.names().iter().any(|name| Quantity::Time.names().contains(&name.as_str())));
    raw.even(|row, message| tables[time.unwrap_or(0)].row_fault(row, &format!("t: {message}")))
}

/// The columns that a mapping names.
fn by_mapping(tables: &[LogTable], mapping: &Mapping, has_rate: bool) -> Result<Vec<Found>, Error> {
    let mut found = Vec::new();
    for map in &mapping.columns {
        let key = map.quantity.key();
        let candidates: Vec<usize> = match &map.file {
            Some(file) => {
                tables.iter().enumerate().filter(|(_, table)| is_called(table.name(), file)).map(|(k, _)| k).collect()
            }
            None => (0..tables.len()).collect(),
        };
        if candidates.is_empty() {
            let list: Vec<&str> = tables.iter().map(LogTable::name).collect();
            let message = format!(
                "{key}: found the file \"{}\", expected one of {}",
                map.file.as_deref().unwrap_or_default(),
                list.join(", ")
            );
            return Err(Error::unknown(message));
        }
        let known = |name: &str| candidates.iter().any(|&k| columns(&tables[k], &[name.to_owned()]).is_some());
        let names = listed(&map.columns, known).map_err(|fault| Error::new(format!("{key}: {fault}")))?;
        let mut matches = candidates.iter().filter_map(|&k| columns(&tables[k], &names).map(|columns| (k, columns)));
        let Some((table, columns)) = matches.next() else {
            return Err(missing(&tables[candidates[0]], key, &names));
        };
        let is_effort = map.quantity.is_effort();
        if columns.contains(&None) && (!is_effort || columns.iter().all(Option::is_none)) {
            return Err(Error::new(format!("{key}: found \"{NONE}\", expected a column")).help(WITHOUT_TORQUE));
        }
        if let Some(held) = tables[table].columns() {
            for &column in columns.iter().flatten() {
                held.numbers(column)?;
            }
        }
        if let Some((other, _)) = matches.next()
            && map.quantity != Quantity::Time
        {
            let (a, b) = (tables[table].name(), tables[other].name());
            let message = format!("{key}: \"{}\" is in {a} and in {b}, expected in one", map.columns);
            return Err(Error::new(message).help(format!("name the file: {key}={}:{}", stem(a), map.columns)));
        }
        found.push(with_unit(
            tables,
            Found { quantity: map.quantity, table, columns, map: map.clone(), unit: map.quantity.units()[0] },
        ));
    }
    // Stamps that the format itself states need not be named.
    let stated = tables.iter().enumerate().find_map(|(k, table)| Some((k, table, table.columns()?.time?)));
    if let Some((k, table, time)) = stated.filter(|_| !has_rate && mapping.columns(Quantity::Time).is_none())
        && let Some(columns) = columns(table, &[time.to_owned()])
    {
        let (quantity, map) = (Quantity::Time, ColumnMap::new(Quantity::Time, time));
        found.push(Found { quantity, table: k, columns, map, unit: Unit::S });
    }
    Ok(found)
}

/// What stands in the place of a column that is left out.
pub(super) const NONE: &str = "-";

/// Who may be left out.
const WITHOUT_TORQUE: &str =
    "- in the place of a column leaves out the torque or the current of a joint, whose position stays";

/// Where columns of these names are, or of their numbers, or all columns of an array; `None` where one is missing.
fn columns(table: &LogTable, names: &[String]) -> Option<Vec<Option<usize>>> {
    let headings = table.names();
    let mut found = Vec::with_capacity(names.len());
    for name in names {
        let numbered =
            || name.strip_prefix('#').and_then(|n| n.parse::<usize>().ok()).filter(|n| (1..=table.width()).contains(n));
        let heading = headings.iter().position(|heading| heading == name);
        match heading.or_else(|| numbered().map(|number| number - 1)) {
            Some(column) => found.push(Some(column)),
            None if name == NONE => found.push(None),
            None => found.extend(table.columns()?.array(name)?.map(Some)),
        }
    }
    Some(found)
}

fn missing(table: &LogTable, key: &str, names: &[String]) -> Error {
    let headings = table.names();
    let name = names.iter().find(|name| columns(table, &[(*name).clone()]).is_none()).cloned().unwrap_or_default();
    let near = suggestion::nearest(&name, headings.iter().map(String::as_str))
        .map(|near| format!("the nearest there is: \"{near}\""));
    let help = table.columns().and_then(|table| table.lacking).map(str::to_owned).or(near);
    table.heading_fault(&format!("{key}: heading \"{name}\" is missing")).maybe_help(help)
}

/// Whether a file may be called so: its path, its name, or its name without ending.
fn is_called(path: &str, name: &str) -> bool {
    path == name || path.rsplit(['/', '\\']).next() == Some(name) || stem(path) == name
}

/// The name of a file without folder and endings.
pub(super) fn stem(path: &str) -> &str {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    let plain = name.strip_suffix(".gz").unwrap_or(name);
    plain.rsplit_once('.').map_or(plain, |(stem, _)| stem)
}

/// With the unit that the mapping says, or that the heading ends with, or SI.
fn with_unit(tables: &[LogTable], mut found: Found) -> Found {
    let table = &tables[found.table];
    let (units, first) = (found.quantity.units(), found.columns.iter().flatten().next());
    let of_file = || first.and_then(|&column| Unit::parse(table.columns()?.unit(column)?, units));
    let of_heading = || first.and_then(|&column| Unit::in_heading(&table.names()[column], units).map(|(unit, _)| unit));
    let said = found.map.unit.or_else(of_file).or_else(of_heading);
    found.unit = said.filter(|unit| *unit != Unit::Percent || found.map.rated.is_some()).unwrap_or(units[0]);
    found
}

/// The columns by what their headings say.
fn by_headings(tables: &[LogTable], has_rate: bool) -> Result<Vec<Found>, Error> {
    let mut all: Vec<Found> = Vec::new();
    for quantity in Quantity::ALL {
        for (table, rows) in tables.iter().enumerate() {
            if !rows.has_headings() || all.iter().any(|found| found.quantity == quantity) {
                continue;
            }
            let headings = rows.names();
            let names: Vec<&str> = headings
                .iter()
                .map(|heading| Unit::in_heading(heading, quantity.units()).map_or(heading.as_str(), |(_, front)| front))
                .collect();
            let at = |name: &str| names.iter().position(|found| found.eq_ignore_ascii_case(name));
            let columns = quantity.names().iter().find_map(|prefix| {
                // What has a number zero counts from it.
                let numbered = [(0, ""), (0, "_"), (1, ""), (1, "_")].into_iter().find_map(|(first, between)| {
                    let columns: Vec<usize> = (first..).map_while(|k| at(&format!("{prefix}{between}{k}"))).collect();
                    (!columns.is_empty()).then_some(columns)
                });
                let one = || {
                    at(prefix)
                        .filter(|&column| rows.columns().is_none_or(|table| table.numbers(column).is_ok()))
                        .map(|column| vec![column])
                };
                if quantity == Quantity::Time { one() } else { numbered.or_else(one) }
            });
            if let Some(columns) = columns {
                let map = ColumnMap::new(quantity, headings[columns[0]].clone());
                let columns = columns.into_iter().map(Some).collect();
                all.push(with_unit(tables, Found { quantity, table, columns, map, unit: quantity.units()[0] }));
            }
        }
    }
    let first = &tables[0];
    let fault = |name: &str| -> Error {
        let headings = first.names();
        let near = suggestion::nearest(name, headings.iter().map(String::as_str))
            .map(|near| format!("; the nearest there is: \"{near}\""));
        let help = || {
            Remedy::from(EXPECTED)
                .setting(Setting::Map)
                .say(", which says what other headings mean: ")
                .assign(Setting::Map, "t=time_ms, q=joint_[1-6]_pos deg, current=i_[1-6] mA")
                .say(", of files side by side ")
                .assign(Setting::Map, "t=time_ms, q=pos:joint_[1-6] deg, current=cur:i_[1-6] mA")
                .say(near.unwrap_or_default())
        };
        let help = first.columns().and_then(|table| table.lacking).map_or_else(help, Remedy::from);
        first.heading_fault(&format!("heading \"{name}\" is missing")).help(help)
    };
    if !first.has_headings() {
        let message = format!("{} columns without headings, expected headings or a mapping", first.width());
        return Err(first.heading_fault(&message).help(
            Remedy::from("state what the columns are: ").assign(Setting::Map, "t=#1, q=#[2-7] deg, tau=#[8-13]"),
        ));
    }
    let has = |quantity| all.iter().find(|found: &&Found| found.quantity == quantity);
    if has(Quantity::Time).is_none() && !has_rate {
        return Err(fault("t"));
    }
    let Some(dof) = has(Quantity::Position).map(|found| found.columns.len()) else { return Err(fault("q1")) };
    // Torques are taken where both are there: they need no constants.
    match (
        has(Quantity::Torque).map(|found| found.columns.len()),
        has(Quantity::Current).map(|found| found.columns.len()),
    ) {
        (Some(count), _) if count == dof => all.retain(|found| found.quantity != Quantity::Current),
        (_, Some(count)) if count == dof => all.retain(|found| found.quantity != Quantity::Torque),
        (Some(count), _) => return Err(fault(&format!("tau{}", count + 1))),
        (None, Some(count)) => return Err(fault(&format!("current{}", count + 1))),
        (None, None) => return Err(fault("tau1")),
    }
    // Velocities of some joints are of no use, nor are positions of some links.
    let extra = |quantity| matches!(quantity, Quantity::Velocity | Quantity::LinkPosition);
    all.retain(|found| !extra(found.quantity) || found.columns.len() == dof);
    Ok(all)
}

const EXPECTED: &str = "expected the headings t,q1..qn,tau1..taun (N·m) or t,q1..qn,current1..currentn (A), or ";

/// Adds a value to each joint of all rows.
fn add_offsets(rows: &mut [f64], offsets: &[f64]) {
    for row in rows.chunks_exact_mut(offsets.len().max(1)) {
        row.iter_mut().zip(offsets).for_each(|(value, offset)| *value += offset);
    }
}

/// From found columns to values.
struct Reader<'a> {
    tables: &'a [LogTable],
    found: Vec<Found>,
    rate_hz: Option<f64>,
}

impl Reader<'_> {
    fn read(&self, files: Vec<FileHash>) -> Result<RawLog, Error> {
        let position = self.get(Quantity::Position).ok_or_else(|| {
            Error::new("q is missing").help(
                Remedy::set(Setting::Map, "t=time, q=joint_[1-6]_pos, tau=torque_[1-6]")
                    .say(" says which columns are what"),
            )
        })?;
        let dof = position.columns.len();
        let mut sized = self.found.iter().filter(|found| found.quantity != Quantity::Time);
        if let Some(found) = sized.find(|found| found.columns.len() != dof) {
            let (key, count) = (found.quantity.key(), found.columns.len());
            return Err(Error::new(format!("{key} names {count} columns, expected {dof}, as many as q")));
        }
        let effort = self.found.iter().find(|found| found.quantity.is_effort());
        let effort = effort.ok_or_else(|| {
            Error::new("tau or current is missing").help(Remedy::set(Setting::Map, "…, tau=torque_[1-6]").say(
                ", or current= with its constants, or q_cmd= with the gains of a servo, says which columns hold it",
            ))
        })?;
        let velocity = self.get(Quantity::Velocity);
        let (conversion, effort_unit) =
            Conversion::of_maps(&position.map, velocity.map(|found| &found.map), &effort.map, dof)?;
        let t = match (self.rate_hz, self.get(Quantity::Time)) {
            (None, None) => {
                let message = format!("{} has no column of times", self.tables[0].name());
                return Err(
                    Error::new(message).help(Remedy::from("state the rows per second: ").assign(Setting::Rate, "HZ"))
                );
            }
            (None, Some(time)) => self.values(time, 1)?,
            (Some(_), _) => Vec::new(),
        };
        let name = self.tables.iter().map(LogTable::name).collect::<Vec<_>>().join(" + ");
        let q = self.values(position, dof)?;
        let rows = q.len() / dof.max(1);
        // Columns of a binary file need not have equal lengths.
        let as_many = |values: Vec<f64>, what: Quantity, width: usize| {
            let found = values.len() / width.max(1);
            let message = || format!("{name}: {} has {found} rows and q has {rows}, expected as many", what.key());
            if found == rows { Ok(values) } else { Err(Error::mismatch(message())) }
        };
        let of = |quantity: Quantity| {
            let values = self.get(quantity).map(|found| as_many(self.values(found, dof)?, quantity, dof));
            values.transpose()
        };
        let t = if t.is_empty() { t } else { as_many(t, Quantity::Time, 1)? };
        let mut efforts = as_many(self.values(effort, dof)?, effort.quantity, dof)?;
        let mut origin = self.origin(files);
        let servo = (effort.quantity == Quantity::Command).then(|| servo::of_map(&effort.map, dof)).transpose()?;
        if let Some(of) = &servo {
            if position.map.motor || velocity.is_some_and(|found| found.map.motor) {
                let message = "q_cmd: found values at the motors in q or qd, expected all of them at the joints";
                return Err(Error::mismatch(message));
            }
            add_offsets(&mut efforts, &effort.map.offsets(dof)?);
            let time = |row: usize| self.rate_hz.map_or_else(|| t[row], |rate| row as f64 / rate);
            efforts = servo::stiffness_torque(of, &efforts, &q, &conversion.offset, time);
            origin.remarks.push(servo::remark(of, velocity.is_some()));
        }
        Ok(RawLog {
            joints: None,
            dof,
            t,
            rate_hz: self.rate_hz,
            qd: of(Quantity::Velocity)?,
            link_q: of(Quantity::LinkPosition)?,
            effort: efforts,
            q,
            without_effort: (0..dof).filter(|&joint| effort.columns[joint].is_none()).collect(),
            effort_unit: Some(effort_unit),
            servo,
            conversion,
            origin,
            name,
        })
    }

    fn get(&self, quantity: Quantity) -> Option<&Found> {
        self.found.iter().find(|found| found.quantity == quantity)
    }

    /// Values in SI units with sign and, where the mapping has it, gear; `n` columns.
    fn values(&self, found: &Found, n: usize) -> Result<Vec<f64>, Error> {
        let table = &self.tables[found.table];
        let there: Vec<usize> = found.columns.iter().flatten().copied().collect();
        let mut values = table.values(&there)?;
        if there.len() < n {
            let rows = values.chunks_exact(there.len().max(1));
            values = rows
                .flat_map(|row| {
                    let mut row = row.iter().copied();
                    found
                        .columns
                        .iter()
                        .map(move |column| if column.is_some() { row.next().unwrap_or(0.0) } else { 0.0 })
                })
                .collect();
        }
        let factor = found.map.factors(found.unit, n)?;
        for row in values.chunks_exact_mut(n) {
            for (value, factor) in row.iter_mut().zip(&factor) {
                *value *= factor;
            }
        }
        Ok(values)
    }

    /// The mapping that the columns are, and what each of them is called in one.
    fn read_as(&self) -> ReadAs {
        let mut mapping = Mapping::default();
        let mut columns = Vec::new();
        for found in &self.found {
            let headings = self.tables[found.table].names();
            let plain = |name: &str| {
                let allowed = |c: char| c.is_alphanumeric() || ['_', '-', '.', '#'].contains(&c);
                !name.is_empty() && name.chars().all(allowed)
            };
            let called = |column: Option<usize>| {
                let Some(column) = column else { return NONE.to_owned() };
                let name = &headings[column];
                let is_first = headings.iter().position(|heading| heading == name) == Some(column);
                if plain(name) && is_first { name.clone() } else { format!("#{}", column + 1) }
            };
            let names: Vec<String> = found.columns.iter().map(|&column| called(column)).collect();
            let mut map = found.map.clone();
            map.columns = names.join("/");
            if self.tables.len() > 1 {
                map.file = Some(stem(self.tables[found.table].name()).to_owned());
            }
            columns.push((found.quantity, names));
            mapping.columns.push(map);
        }
        mapping.columns.sort_by_key(|map| map.quantity);
        ReadAs { mapping, columns }
    }

    fn origin(&self, files: Vec<FileHash>) -> Origin {
        let mut remarks = Vec::new();
        for (k, table) in self.tables.iter().enumerate() {
            let how = table.remarks();
            if !how.is_empty() {
                remarks.push(format!("{}: {}", files[k].path, how.join(", ")));
            }
        }
        if self.rate_hz.is_some() && self.get(Quantity::Time).is_some() {
            remarks.push("the stamps are not used: the rate was given".to_owned());
        }
        let columns = self.found.iter().filter(|found| found.quantity != Quantity::Time || self.rate_hz.is_none());
        let columns = columns.map(|found| {
            let names = self.tables[found.table].names();
            let listed: Vec<&str> =
                found.columns.iter().map(|column| column.map_or(NONE, |at| names[at].as_str())).collect();
            let said = if found.map.unit.is_none() && found.unit != found.quantity.units()[0] {
                ", as in the heading"
            } else {
                ""
            };
            let side = if found.map.motor { " at the motors" } else { "" };
            format!("{} from {} in {}{side}{said}", found.quantity.key(), listed.join(" "), found.unit.name())
        });
        let mut skipped = Vec::new();
        for (k, table) in self.tables.iter().enumerate() {
            for (column, name) in table.names().into_iter().enumerate() {
                if !name.is_empty()
                    && !self.found.iter().any(|found| found.table == k && found.columns.contains(&Some(column)))
                {
                    skipped.push(name);
                }
            }
        }
        let read_as = Some(self.read_as());
        Origin { files, columns: columns.collect(), skipped_columns: skipped, remarks, read_as, ..Origin::default() }
    }
}
