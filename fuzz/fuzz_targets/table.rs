//! Any bytes as arrays of NumPy, Parquet or gzip.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::table(bytes));
