# What one types often. `just` lists the recipes.

# List the recipes.
default:
    @just --list

# Everything that a commit must pass.
test:
    ./scripts/test

# Formatting, lints and documentation, without running a test.
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# Put every file into its format.
format:
    cargo fmt --all

# The command, optimised: `just armid robot crs-a460`.
armid *ARGUMENTS:
    cargo run --release --quiet -- {{ARGUMENTS}}

# Put `armid` on the path.
install:
    cargo install --path cli --locked

# The documentation of the library in a browser.
doc:
    cargo doc -p armid --no-deps --open

# Recordings through an independent reader.
python:
    ./scripts/python-tests
