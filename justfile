# `just check` is what CI runs.
check:
    .ci/run

# Key reference of the files, after a change of keys.
keys:
    WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall-scenarios reference

# Python's keywords and types and the lists of flags, after a change of a request or a result.
stubs:
    WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall-cli --lib stubs
    scripts/result-types
    cd python && WINDFALL_WRITE_REFERENCE=1 pytest -q tests/test_program.py -k every_verb_and_flag

# Wheel, static program, manual pages, completions and crates, each tried where nothing else is.
release:
    scripts/release

# Benches print their own ratios.
bench:
    cargo bench --workspace
