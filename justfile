# `just check` is what CI runs.
check:
    .ci/run

# Tests of minutes that CI leaves out. Those "as long as asked" and studies are not among them.
nightly:
    scripts/nightly

# All that is written from the code: keys of files, Python's keywords and types, flags, answers to wrong inputs. After a change of a key, a request, a
# result, an effect, a method or a format. The last step needs the Python package.
references:
    WINDFALL_WRITE_REFERENCE=1 cargo test --workspace --lib -- reference stubs
    WINDFALL_WRITE_REFERENCE=1 cargo test --workspace --test end_to_end -- law_every_wrong_input_is_answered
    scripts/result-types
    cd python && WINDFALL_WRITE_REFERENCE=1 pytest -q tests/test_program.py -k every_verb_and_flag

# Wheel, static program, manual pages, completions and crates, each tried where nothing else is.
release:
    scripts/release

# Benches print their own ratios.
bench:
    cargo bench --workspace
