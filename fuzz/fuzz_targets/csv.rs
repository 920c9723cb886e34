//! Any bytes as CSV tables.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::csv(bytes));
