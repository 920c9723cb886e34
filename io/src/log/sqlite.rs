//! Files of bags that `ros2 bag record` writes in SQLite: the joint states in them.
//!
//! ```text
//! topics(id, name, type, serialization_format, …)        messages(id, topic_id, timestamp, data)
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use armid::cdr::JointState;
use rusqlite::{Connection, OpenFlags};

use super::topics::{Message, Topics};
use crate::error::Error;

/// How such a file begins.
pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

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
    let fault = |error: rusqlite::Error| Error::new(format!("{name} cannot be read as a bag in SQLite: {error}"));
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let bag = Connection::open_with_flags(path, flags).map_err(fault)?;
    let mut topics: BTreeMap<i64, (String, Vec<Message>)> = BTreeMap::new();
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
    let mut query = bag
        .prepare("SELECT data, timestamp FROM messages WHERE topic_id = ?1 ORDER BY timestamp, id")
        .map_err(fault)?;
    for (id, (topic, messages)) in &mut topics {
        let mut rows = query.query([id]).map_err(fault)?;
        while let Some(row) = rows.next().map_err(fault)? {
            let value = row.get_ref(0).map_err(fault)?;
            let data = value.as_blob().map_err(|error| fault(error.into()))?;
            let state = JointState::decode(data)
                .map_err(|error| Error::new(format!("{name}: message {} on {topic}: {error}", messages.len() + 1)))?;
            messages.push(Message { recorded_ns: row.get(1).map_err(fault)?, state });
        }
    }
    Ok(topics.into_values().collect())
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use armid::cdr::{JointState, Time};
    use rusqlite::Connection;

    use super::super::topics::StateReading;
    use super::topics;
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
            name: vec!["a".to_owned()],
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
        assert!(bag_states(&path).unwrap_err().to_string().contains("no such table: topics"));
        std::fs::write(folder.path().join("bag_0.db3-wal"), "x").unwrap();
        assert!(bag_states(&path).unwrap_err().to_string().contains("was not closed"));
    }
}
