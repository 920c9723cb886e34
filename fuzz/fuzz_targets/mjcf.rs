//! Any bytes as MJCF files.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::mjcf(bytes));
