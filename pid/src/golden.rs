//! pid: golden section search (Kiefer 1953). In: a function of one number and an interval. Out: the place of its smallest value.

/// Middle of an interval of at most `width` about the minimum of a function with one minimum in `[low, high]`, `low < high`, `width > 0`.
#[must_use]
pub fn minimise(f: impl Fn(f64) -> f64, [low, high]: [f64; 2], width: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (low, high);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_c, mut at_d) = (f(c), f(d));
    while b - a > width {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recover_minimum_within_the_width() {
        for at in [-3.9, 0.3, 7.2] {
            assert!((minimise(|x| (x - at).powi(2), [-4.0, 8.0], 1e-3) - at).abs() < 1e-3);
        }
    }
}
