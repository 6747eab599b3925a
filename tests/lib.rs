//! tests: end to end, one binary, see `end_to_end/main.rs`. Nothing is here, so that all tests link once.
