//! Any bytes as URDF files.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| armid_fuzz::mesh(bytes));
