//! Any bytes as CDR messages.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_cli::decoders::cdr(bytes));
