//! Any bytes as journals of studies.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::journal(bytes));
