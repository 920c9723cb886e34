//! Any bytes as estimates in JSON.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::estimate(bytes));
