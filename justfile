# `just check` is what CI runs.
check:
    .ci/run

# Key reference of the files, after a change of keys.
keys:
    WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall-scenarios reference

# Benches print their own ratios.
bench:
    cargo bench --workspace
