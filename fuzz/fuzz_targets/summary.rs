//! Any bytes as stored studies.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::summary(bytes));
