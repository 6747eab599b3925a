//! sim: where each number of a flight's state stands. Out: indices.

/// Number of states that every flight has: position 0-2, velocity 3-5, quaternion 6-9, body rates 10-12, time 13. A loose part
/// (ξ_y, ξ_z and their rates) comes next when there is one, then the operator's V_W and integral.
pub(crate) const BASE: usize = 14;
/// Index of the time that is carried as a state.
pub(crate) const TIME: usize = 13;
