//! model: every number of a plant, once. In: nothing. Out: its key, unit, dimension, range, meaning and place.
//!
//! Readers and writers of files, uncertainties, studies and scaling read this table; a number is added to it and to the plant.

use crate::plant::Plant;

/// Exponents of mass, length and time in a number's unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Of kg.
    pub mass: i8,
    /// Of m.
    pub length: i8,
    /// Of s.
    pub time: i8,
}

/// Where a number can be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// In campaign and scenario files, under its key.
    Declared,
    /// In campaigns of tracks alone: bodies without attitude, and rigid ones in free flight.
    DeclaredOfPoint,
    /// Declared as null; its uncertainty can be given, and effects change it.
    Uncertain,
    /// Declared as null; only effects change it.
    Effect,
}

/// A number of a plant.
#[derive(Clone, Copy, Debug)]
pub struct PlantNumber {
    /// Key of the files with its table, e.g. `vehicle.center_of_mass_m`.
    pub key: &'static str,
    /// Component of a key that has several, e.g. `x`; empty otherwise.
    pub component: &'static str,
    /// SI unit, `rad` of angles, `-` for none.
    pub unit: &'static str,
    /// Dimension by which it scales between full scale and model. Temperatures are not scaled, so neither is a gas constant.
    pub dimension: Dimension,
    /// Whether it is an angle, which files give in degrees.
    pub angle: bool,
    /// Smallest and largest value that files may give, in the file's unit, inclusive.
    pub range: [f64; 2],
    /// What it is.
    pub meaning: &'static str,
    /// Where it can be given.
    pub given: Given,
    /// The number in a plant; none when the plant has no such part.
    pub lens: fn(&mut Plant) -> Option<&mut f64>,
}

impl PlantNumber {
    /// Key and component as one word, e.g. `vehicle.center_of_mass_m.x`.
    #[must_use]
    pub fn name(&self) -> String {
        if self.component.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.key, self.component) }
    }
    /// Unit of the files: that of [`PlantNumber::unit`], degrees of angles.
    #[must_use]
    pub const fn file_unit(&self) -> &'static str {
        if self.angle { "deg" } else { self.unit }
    }
    /// A number of a file, in SI and rad.
    #[must_use]
    pub fn inside(&self, value: f64) -> f64 {
        if self.angle { value.to_radians() } else { value }
    }
}

/// Smallest positive value of a number of which zero makes no sense.
const TINY: f64 = 1e-12;

const PURE: [i8; 3] = [0, 0, 0];
const MASS: [i8; 3] = [1, 0, 0];
const LENGTH: [i8; 3] = [0, 1, 0];
const TIME: [i8; 3] = [0, 0, 1];
const RATE: [i8; 3] = [0, 0, -1];
const AREA: [i8; 3] = [0, 2, 0];
const PER_LENGTH: [i8; 3] = [0, -1, 0];
const PER_AREA: [i8; 3] = [0, -2, 0];
const DENSITY: [i8; 3] = [1, -3, 0];
const MASS_RATE: [i8; 3] = [1, 0, -1];
const SPEED: [i8; 3] = [0, 1, -1];
const ACCELERATION: [i8; 3] = [0, 1, -2];
const INERTIA: [i8; 3] = [1, 2, 0];
const FORCE: [i8; 3] = [1, 1, -2];
const MOMENT: [i8; 3] = [1, 2, -2];
const MOMENT_TIME: [i8; 3] = [1, 2, -1];
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

const CM: &str = "c.m. from the geometric origin, body axes";
const HOOK: &str = "attachment from the geometric origin, body axes";
const RING: &str = "centering ring from the tunnel origin, tunnel axes (X down)";
const LIFTS: &str = "where the displaced air lifts, from the geometric origin, body axes";
const DAMPS: &str = "moment per body rate about each of the coefficients' axes; negative damps";
const SHIFTED: &str = "where parts and thrusts are less where the runs' inputs say, body axes";
const TRACKED: &str = "point of the body whose position is recorded, from the geometric origin, body axes";
const TURNED: &str = "rotation from the true body axes to the reported ones, about each of x, y, z";

/// The table. A line: part of the plant, key, component, SI unit, dimension, range in files, where it is given, meaning, place in the part.
macro_rules! plant_numbers {
    ($($part:ident $key:literal $component:literal, $unit:literal $dimension:ident $range:expr, $given:ident $meaning:expr, $x:ident => $place:expr;)*) => {
        /// Every number of a plant that stands alone; those of aerodynamic structures and contacts come in lists of any length.
        pub const PLANT_NUMBERS: &[PlantNumber] = &[$(PlantNumber {
            key: $key,
            component: $component,
            unit: $unit,
            dimension: Dimension { mass: $dimension[0], length: $dimension[1], time: $dimension[2] },
            angle: matches!($unit.as_bytes(), b"rad"),
            range: $range,
            meaning: $meaning,
            given: Given::$given,
            lens: place!($part $x $place),
        },)*];
    };
}
macro_rules! place {
    (plant $x:ident $place:expr) => {
        |$x| Some($place)
    };
    (tether $x:ident $place:expr) => {
        |plant| plant.tether.as_mut().map(|$x| $place)
    };
    (pivot $x:ident $place:expr) => {
        |plant| plant.point.pivot.as_mut().map(|$x| $place)
    };
    (free $x:ident $place:expr) => {
        |plant| plant.free_flight.as_mut().map(|$x| $place)
    };
    (loose $x:ident $place:expr) => {
        |plant| plant.vehicle.loose.as_mut().map(|$x| $place)
    };
}

plant_numbers! {
    plant "vehicle.mass_kg" "", "kg" MASS [TINY, 1e7], Declared "mass", p => &mut p.vehicle.mass_kg;
    plant "vehicle.inertia_kg_m2.xx" "", "kg m2" INERTIA [0.0, 1e9], Declared "about x", p => &mut p.vehicle.inertia.xx;
    plant "vehicle.inertia_kg_m2.yy" "", "kg m2" INERTIA [0.0, 1e9], Declared "about y", p => &mut p.vehicle.inertia.yy;
    plant "vehicle.inertia_kg_m2.zz" "", "kg m2" INERTIA [0.0, 1e9], Declared "about z", p => &mut p.vehicle.inertia.zz;
    plant "vehicle.inertia_kg_m2.xy" "", "kg m2" INERTIA [-1e9, 1e9], Declared "product", p => &mut p.vehicle.inertia.xy;
    plant "vehicle.inertia_kg_m2.xz" "", "kg m2" INERTIA [-1e9, 1e9], Declared "product", p => &mut p.vehicle.inertia.xz;
    plant "vehicle.inertia_kg_m2.yz" "", "kg m2" INERTIA [-1e9, 1e9], Declared "product", p => &mut p.vehicle.inertia.yz;
    plant "vehicle.center_of_mass_m" "x", "m" LENGTH [-1e3, 1e3], Declared CM, p => &mut p.vehicle.p_origin_cm.xyz[0];
    plant "vehicle.center_of_mass_m" "y", "m" LENGTH [-1e3, 1e3], Declared CM, p => &mut p.vehicle.p_origin_cm.xyz[1];
    plant "vehicle.center_of_mass_m" "z", "m" LENGTH [-1e3, 1e3], Declared CM, p => &mut p.vehicle.p_origin_cm.xyz[2];
    plant "vehicle.reference_diameter_m" "", "m" LENGTH [TINY, 1e3], Declared "reference diameter d; reference area is pi d^2/4", p => &mut p.vehicle.diameter_m;
    plant "vehicle.apparent_axial_kg" "", "kg" MASS ANY, Effect "apparent mass along x", p => &mut p.vehicle.apparent.axial_kg;
    plant "vehicle.apparent_radial_kg" "", "kg" MASS ANY, Effect "apparent mass across x", p => &mut p.vehicle.apparent.radial_kg;
    plant "vehicle.apparent_transverse_kg_m2" "", "kg m2" INERTIA ANY, Effect "apparent inertia about y and z", p => &mut p.vehicle.apparent.transverse_kg_m2;
    loose "vehicle.loose_mass_kg" "", "kg" MASS ANY, Effect "mass of the loose part", l => &mut l.mass_kg;
    loose "vehicle.loose_frequency_hz" "", "Hz" RATE ANY, Effect "natural frequency of the loose part", l => &mut l.frequency_hz;
    loose "vehicle.loose_damping_ratio" "", "-" PURE ANY, Effect "damping ratio of the loose part", l => &mut l.damping_ratio;
    loose "vehicle.loose_x_cm_m" "", "m" LENGTH ANY, Effect "rest place of the loose part from the c.m. along x", l => &mut l.x_cm_m;
    loose "vehicle.loose_in_full" "", "-" PURE ANY, Effect "how much of what is of second order in the loose part's displacement acts", l => &mut l.in_full;
    tether "tether.attachment_m" "x", "m" LENGTH [-1e3, 1e3], Declared HOOK, t => &mut t.p_origin_hook.xyz[0];
    tether "tether.attachment_m" "y", "m" LENGTH [-1e3, 1e3], Declared HOOK, t => &mut t.p_origin_hook.xyz[1];
    tether "tether.attachment_m" "z", "m" LENGTH [-1e3, 1e3], Declared HOOK, t => &mut t.p_origin_hook.xyz[2];
    tether "tether.ring_m" "X", "m" LENGTH [-1e3, 1e3], Declared RING, t => &mut t.p_tunnel_ring.xyz[0];
    tether "tether.ring_m" "Y", "m" LENGTH [-1e3, 1e3], Declared RING, t => &mut t.p_tunnel_ring.xyz[1];
    tether "tether.ring_m" "Z", "m" LENGTH [-1e3, 1e3], Declared RING, t => &mut t.p_tunnel_ring.xyz[2];
    tether "tether.drag_area_m2" "", "m2" AREA [0.0, 1e3], Declared "drag area of the line", t => &mut t.drag_area_m2;
    tether "tether.effective_weight_n" "", "N" FORCE [0.0, 1e6], Declared "weight of the line that the model carries", t => &mut t.weight_n;
    tether "tether.line_rate_n_s_m" "", "N s/m" MASS_RATE ANY, Effect "pull per rate of lengthening", t => &mut t.line_rate_n_s_m;
    tether "tether.length_per_m" "", "1/m" PER_LENGTH ANY, Effect "relative change of the pull per metre of line", t => &mut t.length_per_m;
    tether "tether.ring_shift_m" "Y", "m" LENGTH ANY, Effect "lateral displacement of the ring", t => &mut t.ring_shift_m[0];
    tether "tether.ring_shift_m" "Z", "m" LENGTH ANY, Effect "lateral displacement of the ring", t => &mut t.ring_shift_m[1];
    tether "tether.swivel_n_m" "", "N m" MOMENT ANY, Effect "Coulomb torque of the swivel", t => &mut t.swivel_n_m;
    tether "tether.swivel_rate_rad_s" "", "rad/s" RATE ANY, Effect "roll rate above which the swivel slips", t => &mut t.swivel_rate_rad_s;
    plant "flow.profile_per_m2" "", "1/m2" PER_AREA ANY, Effect "variation of speed with radius squared", p => &mut p.flow.profile_per_m2;
    plant "flow.gradient_per_m" "Y", "1/m" PER_LENGTH ANY, Effect "variation of speed across", p => &mut p.flow.gradient_per_m[0];
    plant "flow.gradient_per_m" "Z", "1/m" PER_LENGTH ANY, Effect "variation of speed across", p => &mut p.flow.gradient_per_m[1];
    plant "flow.swirl_rad_per_m" "", "rad/m" PER_LENGTH ANY, Effect "swirl", p => &mut p.flow.swirl_rad_per_m;
    plant "flow.steady_at_m_s" "", "m/s" SPEED ANY, Effect "tunnel speed to which steady lateral flow is in proportion", p => &mut p.flow.steady_at_m_s;
    plant "flow.angularity_deg" "Y", "rad" PURE ANY, Effect "lateral flow over speed", p => &mut p.flow.angularity_rad[0];
    plant "flow.angularity_deg" "Z", "rad" PURE ANY, Effect "lateral flow over speed", p => &mut p.flow.angularity_rad[1];
    plant "turbulence.axial_rms_m_s" "", "m/s" SPEED ANY, Effect "rms of axial gusts", p => &mut p.turbulence.axial_rms_m_s;
    plant "turbulence.lateral_rms_m_s" "", "m/s" SPEED ANY, Effect "rms of lateral gusts", p => &mut p.turbulence.lateral_rms_m_s;
    plant "turbulence.axial_scale_m" "", "m" LENGTH ANY, Effect "length of axial gusts", p => &mut p.turbulence.axial_scale_m;
    plant "turbulence.lateral_scale_m" "", "m" LENGTH ANY, Effect "length of lateral gusts", p => &mut p.turbulence.lateral_scale_m;
    plant "turbulence.bandwidth" "", "-" PURE ANY, Effect "half-power bandwidth over centre of gusts limited to a band; zero: Dryden's form", p => &mut p.turbulence.bandwidth;
    plant "shedding.moment_rms" "", "-" PURE ANY, Effect "rms of the wake's moment coefficients", p => &mut p.shedding.moment_rms;
    plant "shedding.strouhal" "", "-" PURE ANY, Effect "Strouhal number of the wake", p => &mut p.shedding.strouhal;
    plant "shedding.bandwidth" "", "-" PURE ANY, Effect "relative bandwidth of the wake", p => &mut p.shedding.bandwidth;
    plant "drift.position_rms_m" "X", "m" LENGTH ANY, Effect "rms of the drift of the position", p => &mut p.drift.position_rms_m[0];
    plant "drift.position_rms_m" "Y", "m" LENGTH ANY, Effect "rms of the drift of the position", p => &mut p.drift.position_rms_m[1];
    plant "drift.position_rms_m" "Z", "m" LENGTH ANY, Effect "rms of the drift of the position", p => &mut p.drift.position_rms_m[2];
    plant "drift.attitude_rms_deg" "x", "rad" PURE ANY, Effect "rms of the drift of an angle", p => &mut p.drift.attitude_rms_rad[0];
    plant "drift.attitude_rms_deg" "y", "rad" PURE ANY, Effect "rms of the drift of an angle", p => &mut p.drift.attitude_rms_rad[1];
    plant "drift.attitude_rms_deg" "z", "rad" PURE ANY, Effect "rms of the drift of an angle", p => &mut p.drift.attitude_rms_rad[2];
    plant "drift.speed_rms_m_s" "", "m/s" SPEED ANY, Effect "rms of the drift of the recorded tunnel speed", p => &mut p.drift.speed_rms_m_s;
    plant "scatter.mass" "", "-" PURE ANY, Effect "scatter of the mass from run to run, as a share of it", p => &mut p.scatter.mass;
    plant "scatter.attachment_m" "", "m" LENGTH ANY, Effect "scatter of the tether's attachment from run to run, each axis", p => &mut p.scatter.attachment_m;
    plant "scatter.aero" "", "-" PURE ANY, Effect "scatter of an aerodynamic parameter from run to run, as a share of it", p => &mut p.scatter.aero;
    plant "scatter.aero_place" "", "-" PURE ANY, Effect "place of that parameter in the structure", p => &mut p.scatter.aero_place;
    plant "environment.gravity_m_s2" "", "m/s2" ACCELERATION [0.0, 300.0], Declared "acceleration of gravity", p => &mut p.environment.gravity_m_s2;
    plant "environment.gas_constant_j_kg_k" "", "J/(kg K)" PURE [10.0, 1e4], Declared "specific gas constant", p => &mut p.environment.gas_constant_j_kg_k;
    plant "environment.air_density_kg_m3" "", "kg/m3" DENSITY [0.0, 1e3], DeclaredOfPoint "density of the air", p => &mut p.point.air_density_kg_m3;
    plant "environment.launch_height_m" "", "m" LENGTH [-5e3, 86e3], DeclaredOfPoint "height of the launch in the atmosphere: where the files' heights are zero", p => &mut p.point.launch_height_m;
    pivot "pivot.arm_m" "", "m" LENGTH [TINY, 1e3], DeclaredOfPoint "distance of the mass centre from the pivot's axis", p => &mut p.arm_m;
    pivot "pivot.inertia_kg_m2" "", "kg m2" INERTIA [0.0, 1e9], DeclaredOfPoint "moment of inertia about the mass centre", p => &mut p.inertia_kg_m2;
    pivot "pivot.viscous_n_m_s" "", "N m s" MOMENT_TIME [0.0, 1e6], DeclaredOfPoint "torque of the bearing per rate", p => &mut p.viscous_n_m_s;
    pivot "pivot.dry_n_m" "", "N m" MOMENT ANY, Effect "torque of dry friction", p => &mut p.dry_n_m;
    free "free_flight.reference_area_m2" "", "m2" AREA [TINY, 1e6], DeclaredOfPoint "area that the coefficients are of", f => &mut f.area_m2;
    free "free_flight.buoyancy_kg" "", "kg" MASS [0.0, 1e7], DeclaredOfPoint "displaced air, as a mass", f => &mut f.buoyancy_kg;
    free "free_flight.center_of_buoyancy_m" "x", "m" LENGTH [-1e3, 1e3], DeclaredOfPoint LIFTS, f => &mut f.p_origin_buoyancy.xyz[0];
    free "free_flight.center_of_buoyancy_m" "y", "m" LENGTH [-1e3, 1e3], DeclaredOfPoint LIFTS, f => &mut f.p_origin_buoyancy.xyz[1];
    free "free_flight.center_of_buoyancy_m" "z", "m" LENGTH [-1e3, 1e3], DeclaredOfPoint LIFTS, f => &mut f.p_origin_buoyancy.xyz[2];
    free "free_flight.rate_damping_n_m_s" "x", "N m s" MOMENT_TIME [-1e6, 1e6], DeclaredOfPoint DAMPS, f => &mut f.rate_damping_n_m_s[0];
    free "free_flight.rate_damping_n_m_s" "y", "N m s" MOMENT_TIME [-1e6, 1e6], DeclaredOfPoint DAMPS, f => &mut f.rate_damping_n_m_s[1];
    free "free_flight.rate_damping_n_m_s" "z", "N m s" MOMENT_TIME [-1e6, 1e6], DeclaredOfPoint DAMPS, f => &mut f.rate_damping_n_m_s[2];
    free "free_flight.thrust_excess" "", "-" PURE [-1.0, 10.0], Uncertain "thrusts over those declared, less 1", f => &mut f.thrust_excess;
    free "free_flight.thrust_unequal" "", "-" PURE [-1.0, 1.0], Uncertain "relative excess of thrusts on the right, and lack of those on the left", f => &mut f.thrust_unequal;
    free "free_flight.part_shift_m" "x", "m" LENGTH [-1e3, 1e3], Uncertain SHIFTED, f => &mut f.part_shift.xyz[0];
    free "free_flight.part_shift_m" "y", "m" LENGTH [-1e3, 1e3], Uncertain SHIFTED, f => &mut f.part_shift.xyz[1];
    free "free_flight.part_shift_m" "z", "m" LENGTH [-1e3, 1e3], Uncertain SHIFTED, f => &mut f.part_shift.xyz[2];
    free "free_flight.tracked_point_m" "x", "m" LENGTH [-1e3, 1e3], Uncertain TRACKED, f => &mut f.p_origin_tracked.xyz[0];
    free "free_flight.tracked_point_m" "y", "m" LENGTH [-1e3, 1e3], Uncertain TRACKED, f => &mut f.p_origin_tracked.xyz[1];
    free "free_flight.tracked_point_m" "z", "m" LENGTH [-1e3, 1e3], Uncertain TRACKED, f => &mut f.p_origin_tracked.xyz[2];
    free "free_flight.damping_excess" "x", "-" PURE ANY, Effect "rate damping over that declared, less 1", f => &mut f.damping_excess[0];
    free "free_flight.damping_excess" "y", "-" PURE ANY, Effect "rate damping over that declared, less 1", f => &mut f.damping_excess[1];
    free "free_flight.damping_excess" "z", "-" PURE ANY, Effect "rate damping over that declared, less 1", f => &mut f.damping_excess[2];
    free "free_flight.apparent_kg" "x", "kg" MASS ANY, Effect "apparent mass along a body axis", f => &mut f.apparent_kg[0];
    free "free_flight.apparent_kg" "y", "kg" MASS ANY, Effect "apparent mass along a body axis", f => &mut f.apparent_kg[1];
    free "free_flight.apparent_kg" "z", "kg" MASS ANY, Effect "apparent mass along a body axis", f => &mut f.apparent_kg[2];
    free "free_flight.air_m_s" "X", "m/s" SPEED ANY, Effect "velocity of the air", f => &mut f.v_tunnel_air.xyz[0];
    free "free_flight.air_m_s" "Y", "m/s" SPEED ANY, Effect "velocity of the air", f => &mut f.v_tunnel_air.xyz[1];
    free "free_flight.air_m_s" "Z", "m/s" SPEED ANY, Effect "velocity of the air", f => &mut f.v_tunnel_air.xyz[2];
    plant "sensors.position_std_m" "", "m" LENGTH [0.0, 10.0], Declared "position, each axis", p => &mut p.sensors.position_std_m;
    plant "sensors.roll_std_deg" "", "rad" PURE [0.0, 90.0], Declared "roll angle R_x", p => &mut p.sensors.roll_std_rad;
    plant "sensors.pitch_yaw_std_deg" "", "rad" PURE [0.0, 90.0], Declared "pitch and yaw angles R_y, R_z", p => &mut p.sensors.pitch_yaw_std_rad;
    plant "sensors.wind_std_m_s" "", "m/s" SPEED [0.0, 10.0], Declared "tunnel speed V_W", p => &mut p.sensors.wind_std_m_s;
    plant "sensors.wind_scale" "", "-" PURE [-1.0, 1.0], Uncertain "recorded V_W over the true one, less 1", p => &mut p.sensors.wind_scale;
    plant "sensors.wind_delay_s" "", "s" TIME ANY, Effect "lateness of V_W", p => &mut p.sensors.wind_delay_s;
    plant "sensors.pose_delay_s" "", "s" TIME ANY, Effect "lateness of the pose", p => &mut p.sensors.pose_delay_s;
    plant "sensors.pose_misalignment_deg" "x", "rad" PURE [-90.0, 90.0], Uncertain TURNED, p => &mut p.sensors.misalignment_rad[0];
    plant "sensors.pose_misalignment_deg" "y", "rad" PURE [-90.0, 90.0], Uncertain TURNED, p => &mut p.sensors.misalignment_rad[1];
    plant "sensors.pose_misalignment_deg" "z", "rad" PURE [-90.0, 90.0], Uncertain TURNED, p => &mut p.sensors.misalignment_rad[2];
    plant "sensors.length_scale" "", "-" PURE [-0.5, 0.5], Uncertain "recorded positions over the true ones, less 1", p => &mut p.sensors.length_scale;
    plant "sensors.time_base" "", "-" PURE [-0.5, 0.5], Uncertain "recorded times over the true ones, less 1", p => &mut p.sensors.time_base;
    plant "sensors.specific_force_std_m_s2" "", "m/s2" ACCELERATION [0.0, 100.0], DeclaredOfPoint "specific force, each axis", p => &mut p.sensors.specific_force_std_m_s2;
    plant "sensors.angle_std_deg" "", "rad" PURE [0.0, 90.0], DeclaredOfPoint "angle of a body on a pivot", p => &mut p.sensors.angle_std_rad;
    plant "point.pressure_coefficient" "", "-" PURE ANY, Effect "error of the altimeter's pressure over dynamic pressure", p => &mut p.point.pressure_coefficient;
    plant "point.lift_constant" "", "-" PURE ANY, Effect "lift coefficient", p => &mut p.point.lift_constant;
    plant "point.side_constant" "", "-" PURE ANY, Effect "sideways coefficient", p => &mut p.point.side_constant;
    plant "point.acceleration_m_s2" "X", "m/s2" ACCELERATION ANY, Effect "constant acceleration", p => &mut p.point.acceleration.xyz[0];
    plant "point.acceleration_m_s2" "Y", "m/s2" ACCELERATION ANY, Effect "constant acceleration", p => &mut p.point.acceleration.xyz[1];
    plant "point.acceleration_m_s2" "Z", "m/s2" ACCELERATION ANY, Effect "constant acceleration", p => &mut p.point.acceleration.xyz[2];
    plant "point.apparent_fraction" "", "-" PURE ANY, Effect "apparent mass over displaced air", p => &mut p.point.apparent_fraction;
    plant "point.buoyancy_fraction" "", "-" PURE ANY, Effect "buoyancy over weight of displaced air", p => &mut p.point.buoyancy_fraction;
}
