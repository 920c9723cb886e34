//! Any bytes as CDR messages.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::cdr(bytes));
