//! Any bytes as bags in SQLite.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::sqlite(bytes));
