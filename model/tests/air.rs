//! model tests: the air, its gusts and what a planet adds. In: closed forms and printed rows. Out: whether each sign is right.

use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use windfall_model::frames::{Body, Inertial, Vec3};
use windfall_model::planet::{
    Air, Atmosphere, AtmosphereTable, Gravity, GustProfile, Planet, Reference, Spheroid, WindTable, Winds,
};
use windfall_model::{
    CoefficientTable, DRIFT_TIME_S, Disturbance, Drift, Entry, FreeFlight, PointMass, Record, RunNumber, RunScatter, Setting,
    Shape, ShapingFilter, StateForm, Thrust, Turbulence, WakeShedding,
};

#[track_caller]
fn close(a: f64, b: f64, bound: f64) {
    assert!((a - b).abs() <= bound * (1.0 + b.abs()), "{a} {b}");
}
#[track_caller]
fn same(a: [f64; 3], b: [f64; 3], bound: f64) {
    a.iter().zip(b).for_each(|(a, b)| close(*a, b, bound));
}

/// Scales, rms and frequencies of which none is one.
const RMS: f64 = 0.6;
const T: f64 = 0.7;
const CENTRE: f64 = 5.0;
const WIDE: f64 = 1.2;
const SHAPES: [Shape; 4] = [
    Shape::DrydenLongitudinal { time_s: T },
    Shape::DrydenLateral { time_s: T },
    Shape::Band { centre_rad_s: CENTRE, bandwidth_rad_s: WIDE },
    Shape::Narrow { centre_rad_s: CENTRE, bandwidth_rad_s: WIDE },
];

fn of(shape: Shape) -> Disturbance {
    Disturbance { entry: Entry::AirVelocity(0), rms: RMS, shape }
}

/// The integral over all frequencies is the square of the rms. With ω = s tan θ a rational density is one of sines and cosines of period π,
/// for which the midpoint rule converges as a power: 2000 points leave rounding for poles no nearer the axis than these.
#[test]
fn exact_densities_integrate_to_the_square_of_the_rms() {
    let n = 2000;
    for shape in SHAPES {
        let sum: f64 = (0..n)
            .map(|i| {
                let tangent = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(n)).tan();
                of(shape).density(CENTRE * tangent) * CENTRE * (1.0 + tangent * tangent)
            })
            .sum();
        close(sum * FRAC_PI_2 / f64::from(n), RMS * RMS, 1e-11);
    }
}

/// Dryden's forms where Tω is 0, 1/√3 (the lateral one's top) and 1; both bands at their centre and where half the power is left, which is
/// where |ω² − ω₀²| = bω.
#[test]
fn exact_densities_at_their_landmarks() {
    let at = |shape: Shape, omega: f64| of(shape).density(omega) / (RMS * RMS);
    let [along, across, band, narrow] = SHAPES;
    for (shape, x, expected) in [(along, 0.0, 2.0), (along, 1.0, 1.0), (across, 0.0, 1.0), (across, 1.0, 1.0)] {
        close(at(shape, x / T), expected * T / PI, 1e-13);
    }
    close(at(across, (1.0_f64 / 3.0).sqrt() / T), 9.0 / 8.0 * T / PI, 1e-13);
    let (top, top_narrow) = (2.0 * SQRT_2 / (PI * WIDE), 2.0 / (PI * WIDE));
    close(at(band, CENTRE), top, 1e-13);
    close(at(narrow, CENTRE), top_narrow, 1e-13);
    for side in [-1.0, 1.0] {
        let edge = 0.5 * (side * WIDE + (WIDE * WIDE + 4.0 * CENTRE * CENTRE).sqrt());
        close(at(band, edge), 0.5 * top, 1e-12);
        close(at(narrow, edge), 0.5 * top_narrow * (CENTRE / edge).powi(2), 1e-12);
    }
}

/// |C (iω − A)⁻¹ B|² over π: the one-sided density of a filter whose white noise has a two-sided density of one.
fn filtered<const N: usize>(f: &ShapingFilter<N>, omega: f64) -> f64 {
    let a = DMatrix::from_fn(N, N, |i, j| Complex::new(-f.a[i][j], if i == j { omega } else { 0.0 }));
    let x = a.lu().solve(&DVector::from_fn(N, |i, _| Complex::new(f.b[i], 0.0))).expect("stable");
    (0..N).map(|i| x[i] * f.c[i]).sum::<Complex<f64>>().norm_sqr() / PI
}
fn settles<const N: usize>(f: &ShapingFilter<N>) -> bool {
    DMatrix::from_fn(N, N, |i, j| f.a[i][j]).complex_eigenvalues().iter().all(|e| e.re < 0.0)
}

/// What is drawn has the density that is said: the transfer function of the states against the closed form; and every state settles, one that
/// is not used too, since all are started from the stationary covariance.
#[test]
fn exact_state_forms_have_the_density_of_their_shape() {
    for shape in SHAPES {
        let d = of(shape);
        for omega in [0.3, 1.4, 4.1, 5.0, 6.3, 17.0] {
            let (found, stable) = match d.filter() {
                StateForm::Two(f) => (filtered(&f, omega), settles(&f)),
                StateForm::Four(f) => (filtered(&f, omega), settles(&f)),
            };
            assert!(stable, "{shape:?}");
            close(found / d.density(omega), 1.0, 1e-12);
        }
    }
}

/// V/L by hand: 7 m/s over 0.35 m and 0.14 m; a vortex of Strouhal number 0.2 behind 0.2 m.
#[test]
fn exact_gusts_and_vortices_scale_with_the_speed() {
    let dryden =
        Turbulence { axial_rms_m_s: 0.1, lateral_rms_m_s: 0.2, axial_scale_m: 0.35, lateral_scale_m: 0.14, bandwidth: 0.0 };
    let band = Turbulence { bandwidth: 0.5, ..dryden };
    let across = Turbulence { axial_rms_m_s: 0.0, ..dryden };
    let seen = |t: &Turbulence| -> Vec<(Entry, f64, f64, f64)> {
        let numbers = |s: Shape| match s {
            Shape::DrydenLongitudinal { time_s } => (time_s, 1.0),
            Shape::DrydenLateral { time_s } => (time_s, 2.0),
            Shape::Band { centre_rad_s, bandwidth_rad_s } | Shape::Narrow { centre_rad_s, bandwidth_rad_s } => {
                (centre_rad_s, bandwidth_rad_s)
            }
            Shape::Constant => panic!("no gust"),
        };
        t.disturbances(7.0).into_iter().map(|d| (d.entry, d.rms, numbers(d.shape).0, numbers(d.shape).1)).collect()
    };
    let check = |t: &Turbulence, expected: &[(usize, f64, f64, f64)]| {
        let found = seen(t);
        assert_eq!(found.len(), expected.len());
        for ((entry, rms, a, b), (axis, of, x, y)) in found.into_iter().zip(expected) {
            assert_eq!(entry, Entry::AirVelocity(*axis));
            [(rms, of), (a, x), (b, y)].into_iter().for_each(|(a, b)| close(a, *b, 1e-15));
        }
    };
    check(&dryden, &[(0, 0.1, 0.05, 1.0), (1, 0.2, 0.02, 2.0), (2, 0.2, 0.02, 2.0)]);
    check(&band, &[(0, 0.1, 20.0, 10.0), (1, 0.2, 50.0, 25.0), (2, 0.2, 50.0, 25.0)]);
    check(&across, &[(1, 0.2, 0.02, 2.0), (2, 0.2, 0.02, 2.0)]);
    let shed = WakeShedding { moment_rms: 0.03, strouhal: 0.2, bandwidth: 0.25 }.disturbances(7.0, 0.2);
    assert_eq!(shed.iter().map(|d| d.entry).collect::<Vec<_>>(), [Entry::Coefficient(4), Entry::Coefficient(5)]);
    for d in shed {
        let Shape::Narrow { centre_rad_s, bandwidth_rad_s } = d.shape else { panic!("{d:?}") };
        close(centre_rad_s, 14.0 * PI, 1e-15);
        close(bandwidth_rad_s, 3.5 * PI, 1e-15);
    }
}

/// Drift has an input for each channel, and what differs between runs one for each number.
#[test]
fn exact_drift_and_scatter() {
    let all = Drift { position_rms_m: [0.1, 0.2, 0.3], attitude_rms_rad: [0.4, 0.0, 0.6], speed_rms_m_s: 0.3 }.disturbances();
    let pose = [(0, 0.1), (1, 0.2), (2, 0.3), (3, 0.4), (5, 0.6)].map(|(c, rms)| (Entry::RecordedPose(c), rms)).into_iter();
    let expected: Vec<(Entry, f64)> = pose.chain([(Entry::RecordedSpeed, 0.3)]).collect();
    assert_eq!(all.iter().map(|d| (d.entry, d.rms)).collect::<Vec<_>>(), expected);
    assert!(all.iter().all(|d| d.shape == Shape::DrydenLongitudinal { time_s: DRIFT_TIME_S }));
    let all = RunScatter { mass: 0.1, attachment_m: 0.2, aero: 0.3, aero_place: 1.0 }.disturbances();
    let numbers = [RunNumber::Mass, RunNumber::Attachment(1), RunNumber::Attachment(2), RunNumber::Aero(1)];
    assert_eq!(all.iter().map(|d| d.entry).collect::<Vec<_>>(), numbers.map(Entry::Number));
    assert_eq!(all.iter().map(|d| d.rms).collect::<Vec<_>>(), [0.1, 0.2, 0.2, 0.3]);
    assert!(all.iter().all(|d| d.shape == Shape::Constant && d.density(0.1) == 0.0));
    assert!(RunScatter::default().disturbances().is_empty() && Drift::default().disturbances().is_empty());
}

/// A turning sphere of 1 km with shear in its wind, and a body that climbs straight up from its ground: air and ground velocity by components,
/// the air's acceleration by differences (step 1e-5 s of positions near 2e3 m: round-off 4e-8, truncation less; bound 1e-6).
#[test]
fn exact_air_over_a_turning_planet() {
    let (turns, climb, radius, latitude): (f64, f64, f64, f64) = (0.5, 20.0, 1e3, 0.6);
    let rows = vec![[500.0, 1.0, -6.0], [1500.0, 3.0, 4.0], [2500.0, 3.0, 9.0]];
    let planet = Planet {
        figure: Spheroid { equatorial_radius_m: radius, flattening: 0.0 },
        rotation_rad_s: turns,
        gravity: Gravity::Central { mu_m3_s2: 9e6 },
        atmosphere: None,
        wind: Winds::Table(WindTable::new(rows).expect("ascends")),
    };
    let up = |t: f64| {
        let (s, c) = (turns * t + 0.3).sin_cos();
        [latitude.cos() * c, latitude.cos() * s, latitude.sin()]
    };
    let place = |t: f64| up(t).map(|x| x * (radius + 750.0 + climb * t));
    let velocity = |t: f64| {
        let ([x, y, _], u) = (place(t), up(t));
        [u[0] * climb - turns * y, u[1] * climb + turns * x, u[2] * climb]
    };
    let at = |t: f64| planet.surroundings(Vec3::from_array(place(t)), Vec3::from_array(velocity(t)));
    let wind = |t: f64| {
        let (s, c) = (turns * t + 0.3).sin_cos();
        // A quarter of the way from the first row to the second.
        let (north, east) = (1.0 + 2.0 * (0.25 + climb * t / 1e3), -6.0 + 10.0 * (0.25 + climb * t / 1e3));
        [-latitude.sin() * c * north - s * east, -latitude.sin() * s * north + c * east, latitude.cos() * north]
    };
    let now = at(0.0);
    same(now.v_ground.to_array(), up(0.0).map(|x| x * climb), 1e-9);
    same(now.v_air.to_array(), std::array::from_fn(|i| up(0.0)[i] * climb - wind(0.0)[i]), 1e-9);
    let h = 1e-5;
    let air = |t: f64| -> [f64; 3] { std::array::from_fn(|i| velocity(t)[i] - at(t).v_air.to_array()[i]) };
    same(now.a_air.to_array(), std::array::from_fn(|i| (air(h)[i] - air(-h)[i]) / (2.0 * h)), 1e-6);
    same(now.gravity.to_array(), up(0.0).map(|x| -9e6 / 1750.0_f64.powi(2) * x), 1e-12);
    let (down, p) = (Vec3::<Inertial>::new(0.6, 0.0, -0.8), Vec3::new(1.0, 2.0, 3.0));
    same(Gravity::Uniform { gravity_m_s2: 9.0 }.acceleration(p, down, &planet.figure).to_array(), [5.4, 0.0, -7.2], 1e-15);
    let reference = Reference::of_diameter(3.0);
    close(reference.area_m2, 2.25 * PI, 1e-15);
    assert_eq!((reference.span_m, reference.chord_m), (3.0, 3.0));
}

/// Between rows that begin and end anywhere.
#[test]
fn exact_tables_over_height() {
    let gusts = |x: f64| Turbulence {
        axial_rms_m_s: x,
        lateral_rms_m_s: 2.0 * x,
        axial_scale_m: 10.0 * x,
        lateral_scale_m: 20.0 * x,
        bandwidth: 0.0,
    };
    let profile = GustProfile::new(vec![(200.0, gusts(1.0)), (1200.0, gusts(3.0)), (1400.0, gusts(5.0))]).expect("ascends");
    for (height_m, x) in [(0.0, 1.0), (450.0, 1.5), (1350.0, 4.5), (9e3, 5.0)] {
        let found = profile.at(height_m);
        for (a, b) in [
            (found.axial_rms_m_s, x),
            (found.lateral_rms_m_s, 2.0 * x),
            (found.axial_scale_m, 10.0 * x),
            (found.lateral_scale_m, 20.0 * x),
        ] {
            close(a, b, 1e-14);
        }
    }
    let air = |gas_constant_j_kg_k: f64| Air { pressure_pa: 1e5, temperature_k: 300.0, gas_constant_j_kg_k };
    let table = Atmosphere::Table(AtmosphereTable::new(vec![(100.0, air(200.0)), (300.0, air(240.0))]).expect("good"));
    close(table.at(150.0).gas_constant_j_kg_k, 210.0, 1e-15);
    let drag = CoefficientTable::new(vec![0.5, 0.9, 1.1], vec![0.4, 1.2, 0.6]).expect("ascends");
    for (mach, expected) in [(0.1, 0.4), (0.5, 0.4), (0.6, 0.6), (0.9, 1.2), (1.05, 0.75), (1.1, 0.6), (4.0, 0.6)] {
        close(drag.value(mach), expected, 1e-14);
    }
}

/// US Standard Atmosphere 1976 (NOAA-S/T 76-1562), table I at geometric heights of 1 and 5 km: density 1.1117 and 0.73643 kg/m³, speed of
/// sound 320.55 m/s; half of the last digits printed: 5e-5 of the ratio, 5e-3 m/s.
#[test]
fn pub_air_over_a_launch_site() {
    let point =
        PointMass { air_density_kg_m3: 1.3, launch_height_m: 1e3, atmosphere: Some(Atmosphere::Us1976), ..PointMass::default() };
    let (there, launch) = (point.air(4e3), point.air(0.0));
    assert!((there.density_kg_m3 / (1.3 * 0.736_43 / 1.1117) - 1.0).abs() < 6e-5, "{there:?}");
    assert!((there.sound_m_s - 320.55).abs() < 6e-3, "{there:?}");
    close(launch.density_kg_m3, 1.3, 1e-15);
    let still = PointMass { atmosphere: None, ..point }.air(4e3);
    assert!(still.sound_m_s.is_infinite() && (still.density_kg_m3 - 1.3).abs() < 1e-15);
}

/// Two engines on a beam, one set by the run, the right one stronger than the left; their places by input are shifted, fixed ones are not.
#[test]
fn exact_thrusts_by_hand() {
    let engine = |size_n: Setting, y: Setting| Thrust {
        size_n,
        direction: Vec3::new(0.6, 0.0, -0.8),
        place_m: [Setting::Fixed(0.1), y, Setting::Fixed(0.2)],
    };
    let body = FreeFlight {
        thrusts: vec![engine(Setting::Fixed(2.0), Setting::Input(1)), engine(Setting::Input(0), Setting::Fixed(-0.5))],
        thrust_excess: 0.25,
        thrust_unequal: 0.1,
        part_shift: Vec3::new(0.01, 0.02, 0.03),
        ..FreeFlight::default()
    };
    let [f, m]: [Vec3<Body>; 2] = body.thrust(&[4.0, 0.4]);
    let (right, left) = (2.0 * 1.25 * 1.1, 4.0 * 1.25 * 0.9);
    same(f.to_array(), [0.6 * (right + left), 0.0, -0.8 * (right + left)], 1e-15);
    // r × f of a force along (0.6, 0, −0.8) at (0.1, y, 0.2).
    let moment = |y: f64, size: f64| [-0.8 * y * size, (0.2 * 0.6 + 0.1 * 0.8) * size, -0.6 * y * size];
    let (a, b) = (moment(0.42, right), moment(-0.5, left));
    same(m.to_array(), std::array::from_fn(|i| a[i] + b[i]), 1e-14);
    let middle = FreeFlight { thrusts: vec![engine(Setting::Fixed(2.0), Setting::Fixed(0.0))], ..body };
    close(middle.thrust(&[])[0].x(), 0.6 * 2.5, 1e-15);
}

/// The tunnel's speed where it blows; where the air rests, the speed of the model's own fall, whose exact mean over chords is its distance over time.
#[test]
fn exact_airspeed_of_a_tunnel_and_of_a_fall() {
    let t_s: Vec<f64> = (0..101).map(|i| 0.01 * f64::from(i)).collect();
    let still = vec![0.0; t_s.len()];
    let falling = Record {
        position_m: [t_s.iter().map(|t| 3.0 * t).collect(), t_s.iter().map(|t| 4.0 * t).collect(), still.clone()],
        vw_m_s: still.clone(),
        t_s,
        ..Record::default()
    };
    assert!((falling.mean_airspeed_m_s() - 5.0).abs() < 1e-12);
    let blown = Record { vw_m_s: vec![7.5; still.len()], ..falling.clone() };
    assert_eq!(blown.mean_airspeed_m_s().to_bits(), 7.5_f64.to_bits());
    assert!(Record::default().mean_airspeed_m_s() == 0.0);
}
