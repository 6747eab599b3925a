//! likelihood tests: normal equations against integrals by brute force.

use super::*;

/// Two numbers that stand for each other, the first at its low end and driven out: the second goes to its own top, and not by the
/// step of both, which leads downhill.
#[test]
fn exact_a_number_at_its_end_stays() {
    let a = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]);
    let r = DVector::from_vec(vec![-1.0, -0.5]);
    let (both, _) = step_within(a.clone(), r.clone(), |_, _| false).expect("positive definite");
    assert!(both[0] < 0.0 && both[1] > 0.0);
    let (step, _) = step_within(a.clone(), r.clone(), |i, by| i == 0 && by < 0.0).expect("positive definite");
    assert!(step[0].abs() < 1e-15 && (step[1] + 0.5).abs() < 1e-15);
    assert!(step_within(-a, r, |_, _| false).is_none());
}

/// Three numbers of crooked priors, present values and normal equations.
fn gram() -> Gram {
    let number = |(i, (value, prior)): (usize, (f64, f64))| Number {
        id: crate::model::Id::Generic(i),
        value,
        prior,
        range: [f64::NEG_INFINITY, f64::INFINITY],
        at_end: [false; 2],
        step: 1e-3,
    };
    let numbers = [(0.3, 0.7), (-0.4, 1.3), (0.9, 0.4)].into_iter().enumerate().map(number).collect();
    let g = DMatrix::from_row_slice(3, 3, &[3.1, 0.7, -0.9, 0.7, 1.9, 0.6, -0.9, 0.6, 5.3]);
    Gram::new(numbers, g, DVector::from_vec(vec![1.1, -0.8, 2.3]), 4.2)
}

/// `∫ exp(L) N(θ; 0, S²) dθ` over the numbers at `places`, all others null, with mean and second moments: sums over a grid, which
/// of Gaussians are exact once a step is shorter than the narrowest standard deviation.
fn integrals(gram: &Gram, places: &[usize], likelihood: impl Fn(&[f64; 3]) -> f64) -> (f64, DVector<f64>, DMatrix<f64>) {
    const HALF: i32 = 25;
    const STEP: f64 = 0.22;
    let n = places.len();
    let each = (-HALF..=HALF).map(|k| STEP * f64::from(k));
    let mut points = vec![[0.0; 3]];
    for &at in places {
        let of = |point: [f64; 3]| {
            each.clone().map(move |x| {
                let mut next = point;
                next[at] = x;
                next
            })
        };
        points = points.into_iter().flat_map(of).collect();
    }
    let (mut sum, mut first, mut second) = (0.0, DVector::zeros(n), DMatrix::zeros(n, n));
    for point in points {
        let prior = |i: usize| {
            let s = gram.numbers[i].prior;
            -0.5 * (point[i] / s).powi(2) - (s * std::f64::consts::TAU.sqrt()).ln()
        };
        let weight = (likelihood(&point) + places.iter().map(|&i| prior(i)).sum::<f64>()).exp();
        sum += weight;
        let x = DVector::from_fn(n, |i, _| point[places[i]]);
        first += weight * &x;
        second += weight * &x * x.transpose();
    }
    let mean = first / sum;
    let covariance = second / sum - &mean * mean.transpose();
    (sum.ln() + STEP.ln() * places.iter().map(|_| 1.0).sum::<f64>(), mean, covariance)
}

/// What a set is worth, its means and covariance, the value and step of Laplace's approximation (of a parabola exact), and what is
/// left beside numbers that are always in: all by integrals over a grid.
#[test]
fn exact_integrals_over_numbers() {
    let gram = gram();
    let from_null = |x: &[f64; 3]| {
        let x = DVector::from_row_slice(x);
        gram.b.dot(&x) - 0.5 * x.dot(&(&gram.g * &x))
    };
    let from_here = |x: &[f64; 3]| {
        let by = DVector::from_fn(3, |i, _| x[i] - gram.numbers[i].value);
        gram.log_likelihood + gram.b_here.dot(&by) - 0.5 * by.dot(&(&gram.g * &by))
    };
    let gain = |places: &[usize]| {
        let (worth, mean, covariance) = integrals(&gram, places, from_null);
        let found = gram.posterior(places).expect("positive definite");
        assert!((found.gain - worth).abs() < 1e-9, "{places:?}: {} {worth}", found.gain);
        assert!((&found.mean - &mean).amax() < 1e-9 && (&found.covariance - covariance).amax() < 1e-9);
        let mut at = [0.0; 3];
        places.iter().enumerate().for_each(|(k, &i)| at[i] = mean[k]);
        assert!((found.fit - from_null(&at)).abs() < 1e-9);
        worth
    };
    let (two, one) = (gain(&[2, 0]), gain(&[1]));
    let (worth, mean, covariance) = integrals(&gram, &[0, 1, 2], from_here);
    let (total, step, found) = gram.laplace().expect("positive definite");
    assert!((total - worth).abs() < 1e-9 && (found - covariance).amax() < 1e-9, "{total} {worth}");
    assert!((0..3).all(|i| (gram.numbers[i].value + step[i] - mean[i]).abs() < 1e-9), "{step} {mean}");
    let all = gram.posterior(&[0, 1, 2]).expect("positive definite").gain;
    let left = gram.given(&[1], &[0, 2]).and_then(|g| g.posterior(&[1, 0])).expect("positive definite").gain;
    assert!((left - (all - one)).abs() < 1e-12, "{left} {all} {one}");
    let left = gram.given(&[2, 0], &[1]).and_then(|g| g.posterior(&[0])).expect("positive definite").gain;
    assert!((left - (all - two)).abs() < 1e-12);
}
