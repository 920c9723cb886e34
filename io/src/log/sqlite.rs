//! Files of bags that `ros2 bag record` writes in SQLite: the joint states in them.
//!
//! ```text
//! topics(id, name, type, serialization_format, …)        messages(id, topic_id, timestamp, data)
//! ```
//!
//! A database is a program: views never end, and pages that several rows share hold more than the file. Only plain tables are read,
//! in so many steps for each byte of the file, and for no more bytes of messages than the file has.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use armid_cdr::JointState;
use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension};

use super::topics::{Message, Topics};
use crate::error::Error;

/// How such a file begins.
pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Steps of SQLite's machine for each byte of a file: a row of a scan takes about ten, and more than ten bytes.
const STEPS_PER_BYTE: u64 = 50;
/// Steps for a file of any size: its schema, and what is asked of it.
const STEPS: u64 = 200_000;
/// Steps between two looks at how many there were.
const STEPS_AT_ONCE: u64 = 1000;

/// The joint states of one file by topic, in the order of their times.
///
/// # Errors
/// [`Error`] where the file is no such database, is still being written, or a message is no joint state.
pub(super) fn topics(path: &Path) -> Result<Topics, Error> {
    let name = path.display().to_string();
    let mut journal = path.as_os_str().to_owned();
    journal.push("-wal");
    // What the journal holds is not in the file.
    if std::fs::metadata(PathBuf::from(&journal)).is_ok_and(|about| about.len() > 0) {
        let message = format!("{name} was not closed: {} holds a part of it", journal.to_string_lossy());
        return Err(
            Error::new(message).help("`sqlite3 FILE .schema` brings both together, where nothing records any more")
        );
    }
    let bytes = std::fs::metadata(path).map_err(|error| Error::unreadable(path, &error))?.len();
    let steps = STEPS + STEPS_PER_BYTE * bytes;
    let fault = |error: rusqlite::Error| {
        if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) {
            let message =
                format!("{name} is not read in {steps} steps of SQLite, expected no more for its {bytes} bytes");
            return Error::new(message).help("its rows share pages: a recorder writes no such file");
        }
        Error::new(format!("{name} cannot be read as a bag in SQLite: {error}"))
    };
    let bag = opened(path, bytes, steps).map_err(fault)?;
    for table in ["topics", "messages"] {
        let find = "SELECT type, rootpage FROM sqlite_master WHERE lower(name) = ?1";
        let found = bag.query_row(find, [table], |row| Ok((row.get::<_, String>(0)?, row.get::<_, Option<i64>>(1)?)));
        let found = match found.optional().map_err(fault)? {
            Some((kind, root)) if kind == "table" && root.is_some_and(|root| root > 0) => continue,
            Some((kind, _)) if kind == "table" => "a virtual table".to_owned(),
            Some((kind, _)) => format!("a {kind}"),
            None => "none".to_owned(),
        };
        let message = format!("{name} cannot be read as a bag in SQLite: found {found}, expected a table \"{table}\"");
        return Err(Error::new(message));
    }
    let mut topics: BTreeMap<i64, (String, Vec<(i64, Message)>)> = BTreeMap::new();
    let mut query = bag.prepare("SELECT id, name, type, serialization_format FROM topics").map_err(fault)?;
    let mut rows = query.query([]).map_err(fault)?;
    while let Some(row) = rows.next().map_err(fault)? {
        let text = |column: usize| row.get::<_, String>(column).map_err(fault);
        if text(2)? != JointState::NAME {
            continue;
        }
        let (topic, format) = (text(1)?, text(3)?);
        if format != "cdr" {
            return Err(Error::new(format!("{name}: {topic} is in \"{format}\", expected cdr, as recorded by ROS 2")));
        }
        topics.insert(row.get(0).map_err(fault)?, (topic, Vec::new()));
    }
    let mut query = bag.prepare("SELECT data, timestamp, id FROM messages WHERE topic_id = ?1").map_err(fault)?;
    let mut read_bytes = 0;
    for (id, (topic, messages)) in &mut topics {
        let mut rows = query.query([id]).map_err(fault)?;
        while let Some(row) = rows.next().map_err(fault)? {
            let value = row.get_ref(0).map_err(fault)?;
            let data = value.as_blob().map_err(|error| fault(error.into()))?;
            read_bytes += data.len() as u64;
            if read_bytes > bytes {
                let message =
                    format!("{name} holds more bytes of messages than the {bytes} that it has, expected fewer");
                return Err(Error::new(message).help("its rows share pages: a recorder writes no such file"));
            }
            let (recorded_ns, number) = (row.get(1).map_err(fault)?, row.get(2).map_err(fault)?);
            let state = JointState::decode(data)
                .map_err(|error| Error::new(format!("{name}: message {number} on {topic}: {error}")))?;
            let state = state.sharing_names(messages.last().map(|(_, last): &(i64, Message)| &last.state));
            messages.push((number, Message { recorded_ns, state }));
        }
        messages.sort_by_key(|(number, message)| (message.recorded_ns, *number));
    }
    let in_order = |(topic, messages): (String, Vec<(i64, Message)>)| {
        (topic, messages.into_iter().map(|(_, message)| message).collect())
    };
    Ok(topics.into_values().map(in_order).collect())
}

/// A database in which the schema of a stranger runs nothing, no value is longer than the file, and an operation ends after so
/// many steps.
fn opened(path: &Path, bytes: u64, steps: u64) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut bag = Connection::open_with_flags(path, flags)?;
    for (config, value) in [
        (DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false),
        (DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false),
        (DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false),
        (DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true),
    ] {
        bag.set_db_config(config, value)?;
    }
    // Statements of armid's own have a length, too.
    bag.set_limit(Limit::SQLITE_LIMIT_LENGTH, i32::try_from(bytes.max(1 << 16)).unwrap_or(i32::MAX))?;
    let mut taken = 0;
    let count = move || {
        taken += STEPS_AT_ONCE;
        taken > steps
    };
    bag.progress_handler(STEPS_AT_ONCE as i32, Some(count))?;
    Ok(bag)
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use armid_cdr::{JointState, Time};
    use rusqlite::Connection;

    use super::super::topics::StateReading;
    use super::{ErrorCode, opened, topics};
    use crate::error::Error;
    use crate::log::Mapping;

    fn bag_states(path: &Path) -> Result<Vec<JointState>, Error> {
        let messages = StateReading::default().one_topic("bag", topics(path)?)?;
        Ok(messages.into_iter().map(|message| message.state).collect())
    }

    fn state(k: i32) -> JointState {
        JointState {
            stamp: Time { sec: k, nanosec: 5 },
            frame_id: String::new(),
            name: ["a".to_owned()].into(),
            position: vec![f64::from(k)],
            velocity: Vec::new(),
            effort: vec![1.5],
        }
    }

    /// A bag with these topics (id, name, type, format) and messages (topic, time, bytes).
    fn bag(folder: &Path, topics: &[(i64, &str, &str, &str)], messages: &[(i64, i64, Vec<u8>)]) -> PathBuf {
        let path = folder.join("bag_0.db3");
        let bag = Connection::open(&path).unwrap();
        bag.execute_batch(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT \
             NOT NULL, offered_qos_profiles TEXT NOT NULL);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB \
             NOT NULL);",
        )
        .unwrap();
        for (id, name, kind, format) in topics {
            bag.execute("INSERT INTO topics VALUES (?1, ?2, ?3, ?4, '')", (id, name, kind, format)).unwrap();
        }
        for (topic, time, data) in messages {
            bag.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)", (topic, time, data))
                .unwrap();
        }
        path
    }

    const JOINTS: &str = "sensor_msgs/msg/JointState";

    #[test]
    fn joint_states_are_read_in_the_order_of_their_times() {
        let folder = tempfile::tempdir().unwrap();
        let topics = [
            (1, "/rosout", "rcl_interfaces/msg/Log", "cdr"),
            (2, "/joint_states", JOINTS, "cdr"),
            (3, "/other", JOINTS, "cdr"),
        ];
        let messages = [
            (2, 20, state(2).encode().unwrap()),
            (1, 5, vec![1, 2, 3]),
            (2, 10, state(1).encode().unwrap()),
            (3, 1, state(9).encode().unwrap()),
        ];
        let path = bag(folder.path(), &topics, &messages);
        assert_eq!(bag_states(&path).unwrap(), [state(1), state(2)]);
    }

    #[test]
    fn the_only_topic_is_taken_and_several_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let both = [(1, "/arm/states", JOINTS, "cdr"), (2, "/hand/states", JOINTS, "cdr")];
        let path = bag(folder.path(), &both, &[(1, 1, state(3).encode().unwrap())]);
        assert_eq!(bag_states(&path).unwrap(), [state(3)]);
        std::fs::remove_file(&path).unwrap();
        let path = bag(folder.path(), &both, &[(1, 1, state(3).encode().unwrap()), (2, 1, state(3).encode().unwrap())]);
        let fault = bag_states(&path).unwrap_err().to_string();
        assert!(fault.contains("on /arm/states, /hand/states, expected /joint_states"), "{fault}");
        // The one that is stated, with the times at which the recorder had its messages.
        let stated = |topic: &str| {
            let mapping = Mapping::parse(topic).unwrap();
            StateReading { mapping: Some(&mapping), robot: None }.one_topic("bag", topics(&path).unwrap())
        };
        let found = stated("topic=/hand/states").unwrap();
        assert_eq!(
            found.iter().map(|message| (message.recorded_ns, message.state.clone())).collect::<Vec<_>>(),
            [(1, state(3))]
        );
        let fault = stated("topic=/states").unwrap_err().to_string();
        assert!(fault.contains("no joint states on /states, found /arm/states, /hand/states"), "{fault}");
    }

    #[test]
    fn what_is_no_bag_is_refused_with_its_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = bag(folder.path(), &[(1, "/joint_states", JOINTS, "cdr")], &[(1, 1, vec![0, 1, 0, 0, 7])]);
        assert!(bag_states(&path).unwrap_err().to_string().contains("message 1 on /joint_states"));
        std::fs::remove_file(&path).unwrap();
        let path = bag(folder.path(), &[(1, "/joint_states", JOINTS, "protobuf")], &[]);
        assert!(bag_states(&path).unwrap_err().to_string().contains("in \"protobuf\", expected cdr"));
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        assert!(bag_states(&path).unwrap_err().to_string().contains("cannot be read as a bag in SQLite"));
        std::fs::write(&path, "").unwrap();
        let fault = bag_states(&path).unwrap_err().to_string();
        assert!(fault.contains("found none, expected a table \"topics\""), "{fault}");
        std::fs::write(folder.path().join("bag_0.db3-wal"), "x").unwrap();
        assert!(bag_states(&path).unwrap_err().to_string().contains("was not closed"));
    }

    #[test]
    fn a_schema_that_computes_is_refused_before_it_runs() {
        let folder = tempfile::tempdir().unwrap();
        let endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id";
        let messages = format!("{endless}, 1 AS topic_id, i AS timestamp, zeroblob(1000) AS data FROM n");
        let topics = format!("{endless}, 'x' AS name, '{JOINTS}' AS type, 'cdr' AS serialization_format FROM n");
        for (table, schema, found) in [
            ("messages", format!("CREATE VIEW messages AS {messages}"), "found a view"),
            ("topics", format!("CREATE VIEW Topics AS {topics}"), "found a view"),
            (
                "messages",
                "CREATE VIRTUAL TABLE messages USING fts5(id, topic_id, timestamp, data)".into(),
                "found a virtual",
            ),
        ] {
            let path = bag(folder.path(), &[(1, "/joint_states", JOINTS, "cdr")], &[]);
            Connection::open(&path).unwrap().execute_batch(&format!("DROP TABLE {table}; {schema};")).unwrap();
            let fault = bag_states(&path).unwrap_err().to_string();
            assert!(fault.contains(found) && fault.contains(&format!("expected a table \"{table}\"")), "{fault}");
            std::fs::remove_file(&path).unwrap();
        }
        // A column that is computed, and longer than the file.
        let path = bag(folder.path(), &[(1, "/joint_states", JOINTS, "cdr")], &[]);
        let columns = "id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data AS (zeroblob(100000000))";
        let schema =
            format!("DROP TABLE messages; CREATE TABLE messages({columns}); INSERT INTO messages VALUES (1, 1, 1);");
        Connection::open(&path).unwrap().execute_batch(&schema).unwrap();
        let fault = bag_states(&path).unwrap_err().to_string();
        assert!(fault.contains("too big"), "{fault}");
        // Whatever else may run: it ends.
        let endless = format!("SELECT count(*) FROM ({endless} FROM n)");
        let fault = opened(&path, 1000, 100_000).unwrap().query_row(&endless, [], |_| Ok(())).unwrap_err();
        assert_eq!(fault.sqlite_error_code(), Some(ErrorCode::OperationInterrupted));
    }

    #[test]
    fn rows_that_share_pages_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let one = state(1).encode().unwrap();
        let path = bag(folder.path(), &[(1, "/joint_states", JOINTS, "cdr")], &[]);
        let mut connection = Connection::open(&path).unwrap();
        let all = connection.transaction().unwrap();
        for time in 0..40_000 {
            all.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?1, ?2)", (time, &one)).unwrap();
        }
        all.commit().unwrap();
        let root: usize = connection
            .query_row("SELECT rootpage FROM sqlite_master WHERE name = 'messages'", [], |row| row.get::<_, u32>(0))
            .unwrap() as usize;
        drop(connection);
        assert_eq!(bag_states(&path).unwrap().len(), 40_000);
        // The file format: kind 5 is an inner page, its cells begin with the number of a child, the last child is in its head.
        let whole = std::fs::read(&path).unwrap();
        let number = |at: usize| u32::from_be_bytes(whole[at..at + 4].try_into().unwrap()) as usize;
        let short = |at: usize| usize::from(u16::from_be_bytes([whole[at], whole[at + 1]]));
        let page = |number: usize| (number - 1) * short(16);
        let children = |inner: usize| -> Vec<usize> {
            assert_eq!(whole[page(inner)], 5, "an inner page");
            (0..short(page(inner) + 3)).map(|k| page(inner) + short(page(inner) + 12 + 2 * k)).collect()
        };
        let first = number(children(root)[0]);
        let last = number(page(root) + 8);
        // The children of the first inner page become the last one, whose rows come again and again, or itself.
        for (child, words) in [(last, "more bytes of messages than the"), (first, "cannot be read as a bag")] {
            let mut bytes = whole.clone();
            for at in children(first) {
                bytes[at..at + 4].copy_from_slice(&(child as u32).to_be_bytes());
            }
            std::fs::write(&path, &bytes).unwrap();
            let fault = bag_states(&path).unwrap_err().to_string();
            assert!(fault.contains(words), "{fault}");
        }
    }
}
