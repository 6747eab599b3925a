# `just check` is what CI runs.
check:
    .ci/run

# Key reference of the files, after a change of keys.
keys:
    WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall-scenarios reference

# Python's keywords and the list of flags, after a change of a request.
stubs:
    WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall-cli --lib stubs

# Benches print their own ratios.
bench:
    cargo bench --workspace
