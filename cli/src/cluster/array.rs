//! Arrays of tasks within the largest index that a cluster allows.

use std::fmt::Write;

/// Tasks of one array: task `first + index` for each index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Array {
    pub(super) first: usize,
    indices: Vec<usize>,
}

impl Array {
    /// Splits task numbers, counted from one and ascending, so that every index stays below `max_size`.
    pub(super) fn split(tasks: &[usize], max_size: usize) -> Vec<Self> {
        let mut arrays: Vec<Self> = Vec::new();
        for &task in tasks {
            let (first, index) = ((task - 1) / max_size * max_size + 1, (task - 1) % max_size);
            match arrays.last_mut() {
                Some(array) if array.first == first => array.indices.push(index),
                _ => arrays.push(Self { first, indices: vec![index] }),
            }
        }
        arrays
    }

    /// The task numbers.
    pub(super) fn tasks(&self) -> Vec<usize> {
        self.indices.iter().map(|index| self.first + index).collect()
    }

    /// The indices as a batch system wants them: `0-3,7`.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let mut at = 0;
        while at < self.indices.len() {
            let begin = self.indices[at];
            let mut end = begin;
            while self.indices.get(at + 1) == Some(&(end + 1)) {
                (at, end) = (at + 1, end + 1);
            }
            let comma = if text.is_empty() { "" } else { "," };
            let _ = if begin == end { write!(text, "{comma}{begin}") } else { write!(text, "{comma}{begin}-{end}") };
            at += 1;
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::Array;

    #[test]
    fn neighbours_are_a_range_and_no_index_reaches_the_largest_size() {
        let arrays = Array::split(&[1, 2, 3, 5, 9, 10, 11, 21], 10);
        let texts: Vec<(usize, String)> = arrays.iter().map(|array| (array.first, array.text())).collect();
        assert_eq!(texts, [(1, "0-2,4,8-9".to_owned()), (11, "0".to_owned()), (21, "0".to_owned())]);
        let tasks: Vec<usize> = arrays.iter().flat_map(Array::tasks).collect();
        assert_eq!(tasks, [1, 2, 3, 5, 9, 10, 11, 21]);
    }

    #[test]
    fn no_task_is_no_array() {
        assert!(Array::split(&[], 1001).is_empty());
    }
}
