//! Any bytes as MCAP recordings.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::mcap(bytes));
