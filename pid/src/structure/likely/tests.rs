//! pid tests: columns of candidates and back.

use super::*;

/// Candidates pool after pool, each with a column, and columns back to these candidates.
#[test]
fn exact_columns_of_candidates_and_back() {
    let candidates = [vec![3, 5, 9], vec![], vec![0, 4], vec![7]];
    let columns = columns_of(&candidates);
    assert_eq!(columns, [vec![0, 1, 2], vec![], vec![3, 4], vec![5]]);
    assert_eq!(back(&[4], &candidates[2], &columns[2]), [4]);
    assert_eq!(back(&[0, 2], &candidates[0], &columns[0]), [3, 9]);
    assert_eq!(back(&[], &candidates[1], &columns[1]), [0; 0]);
}
