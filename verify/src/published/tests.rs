//! verify tests: printed numbers are met.

use super::*;
use crate::tests::{pass, with_setups};

#[test]
fn pub_numbers_of_the_thesis() {
    with_setups(|s| pass(&checks(s).expect("flies")));
}
