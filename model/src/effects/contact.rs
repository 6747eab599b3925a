//! model: effect `contact`.

use super::{Acts, Effect, Parameter, Role};
use crate::frames::Vec3;
use crate::plant::Contact;

/// Longest pulse, s. One may be under way when the run begins.
const LONGEST_S: f64 = 2.0;

pub(super) static EFFECT: Effect = Effect {
    family: "contact",
    acts: Acts::Lander,
    physics: "The pole or a slack line touches the model inside the window: a short pulse of force and moment in one run.",
    source: "Thesis §5.1: windows start where the pole leaves the model, judged by eye from video",
    separate_by: "video of the run, or a window that starts later",
    parameters: |_| {
        let mut all = vec![
            Parameter {
                name: "run".to_owned(),
                unit: "-",
                low: 0.0,
                high: 1e6,
                usual: 1e6,
                null: 0.0,
                role: Role::Run,
                step: 0.0,
                net: None,
            },
            Parameter {
                name: "start_s".to_owned(),
                unit: "s",
                low: -LONGEST_S,
                high: 1e6,
                usual: 1e6,
                null: 0.0,
                role: Role::Instant,
                step: 0.0,
                net: None,
            },
            Parameter::shape("duration_s", "s", 0.01, LONGEST_S, 0.15, &[0.15, 0.4]),
        ];
        all.extend(["impulse_x_n_s", "impulse_y_n_s", "impulse_z_n_s"].map(|n| Parameter::strength(n, "N s", 5.0)));
        all.extend(["angular_x_n_m_s", "angular_y_n_m_s", "angular_z_n_m_s"].map(|n| Parameter::strength(n, "N m s", 1.0)));
        all
    },
    apply: |plant, v| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small run index, checked at the door")]
        let run = v[0] as usize;
        plant.contacts.push(Contact {
            run,
            start_s: v[1],
            duration_s: v[2],
            impulse: Vec3::new(v[3], v[4], v[5]),
            angular_impulse: Vec3::new(v[6], v[7], v[8]),
        });
    },
};
