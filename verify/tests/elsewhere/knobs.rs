//! Every number that can act beyond the declared model, by the name it has in answers.json; zero is absent.

macro_rules! knobs {
    ($($knob:ident $name:literal $what:literal;)*) => {
        /// One number.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Knob { $(#[doc = $what] $knob,)* }
        const NAMES: &[&str] = &[$($name,)*];
        /// All of them, in the order of their index.
        pub(crate) const ALL: &[Knob] = &[$(Knob::$knob,)*];
    };
}

knobs! {
    MaX "ma_x" "apparent mass along x, kg";
    MaR "ma_r" "apparent mass across x, kg";
    IaR "Ia_r" "apparent inertia about y and z, kg m²";
    Cm0 "Cm0" "constant C_m";
    Cn0 "Cn0" "constant C_n";
    CY0 "CY0" "constant C_Y";
    CN0 "CN0" "constant C_N";
    CA2 "CA2" "C_A by sin² α_T";
    CA4 "CA4" "C_A by sin⁴ α_T";
    CaV "CAV" "C_A by (V/trim − 1) cos α_T, over C_A0";
    CNq "CNq" "C_N by q̂, C_Y by r̂";
    Mag "mag" "C_m and C_n by p̂ sin α_T across the plane of the angle";
    MagF "mag_f" "the same of the force";
    Bump "bump" "damping by sech² (α_T/width)";
    BumpWidth "bump_width" "its width, rad";
    Clps "Clps" "roll damping by sin² α_T";
    Clpp "Clpp" "roll damping by |p̂|";
    RpCos "rp_cos" "static moment by the clock angle, cosine";
    RpSin "rp_sin" "sine";
    RpN "rp_n" "its harmonic";
    Prof "prof" "speed by (r/3.05 m)²";
    TiltY "tilt_y" "speed by Y, 1/m";
    TiltZ "tilt_z" "speed by Z, 1/m";
    Swirl "swirl" "rotation of the stream at trim speed, rad/s";
    Vy "vy" "cross-flow along Y at trim speed, m/s";
    Vz "vz" "along Z";
    Shed "shed" "rms of C_m and C_n by the wake";
    Strouhal "shed_st" "its Strouhal number";
    ShedBand "shed_bw" "its relative bandwidth";
    TethC "teth_c" "pull by the line's rate, N s/m";
    TethLen "teth_len" "pull by the line's length, 1/m";
    RingY "ring_y" "ring from where it is declared, m";
    RingZ "ring_z" "ring from where it is declared, m";
    Ixy "Ixy" "product of inertia, kg m²";
    Ixz "Ixz" "product of inertia, kg m²";
    Iyz "Iyz" "product of inertia, kg m²";
    SloshM "slosh_m" "loose mass, kg";
    SloshHz "slosh_hz" "its frequency";
    SloshZeta "slosh_zeta" "its damping ratio";
    SloshX "slosh_x" "its place along x from the c.m., m";
    Vscale "Vscale" "recorded speed over true, less one";
    Vdelay "Vdelay" "recorded speed is that long ago, s";
    MisX "mis_x" "reported axes against true ones, rad";
    MisY "mis_y" "about y";
    MisZ "mis_z" "about z";
    PoseDelay "pose_delay" "recorded pose is that long ago, s";
    LengthScale "length_scale" "recorded position over true, less one";
    TimeScale "time_scale" "recorded time over true, less one";
    Swivel "swivel" "friction of the swivel about x, N m";
    HitRun "hit_run" "run that is touched, from one";
    HitAt "hit_at" "when, s";
    HitFor "hit_for" "how long, s";
    HitF "hit_f" "impulse along Y body, N s";
    HitM "hit_m" "angular impulse about z body, N m s";
    Hyst "hyst" "static moment by the sign of the angle's rate";
    Tone "tone" "speed of the stream at a tone, m/s";
    ToneHz "tone_hz" "its frequency";
    SideTone "side_tone" "lateral gust that comes regularly, m/s";
    SideHz "side_hz" "how often";
    Pole "pole" "deficit of speed behind a pole";
    Jump "jump" "static moment that jumps at an angle";
    JumpAt "jump_at" "sine of that angle";
    DampTime "damp_time" "damping grows by this part in ten seconds";
    Stick "stick" "Coulomb friction of the line in the ring, N";
    Snap "snap" "stiffness of the line beyond its length at release, N/m";
    ProbeHeat "probe_heat" "recorded speed drifts by this part";
    ProbeBend "probe_bend" "recorded speed bends about trim, 1/(m/s)";
    Magnet "magnet" "moment of a dipole along y in a field fixed in the tunnel, N m";
    LagN "lag_n" "normal force comes that late, s";
    Fluid "fluid" "inertia of a fluid inside, kg m²";
    FluidTime "fluid_time" "its coupling, s";
    Leak "leak" "mass lost per ten seconds, part";
    Bend "bend" "C_m of an outrigger that bends";
    BendHz "bend_hz" "its frequency";
    CmV "CmV" "static moment by V/V_trim − 1, part";
    RollPitch "roll_pitch" "C_l by α β";
    HeightFlow "height_flow" "cross-flow along Y by height, rad/m";
    Scatter "scatter" "C_m0 that differs from run to run";
    Wall "wall" "force to the axis by r³, coefficient at 1 m";
    RollBias "roll_bias" "position off by three times the roll, m";
    YawDrift "yaw_drift" "yaw of the tracker drifts, rad/s";
    YawStep "yaw_step" "yaw of the tracker steps, rad";
    QQ "qq" "damping by q̂ |q̂|";
    Gyro "gyro" "angular momentum of a rotor along x, N m s";
    RingSway "ring_sway" "amplitude of a swinging ring, m";
    Shear "shear" "speed by height, 1/m";
    Warm "warm" "density falls by this part in ten seconds, not recorded";
    Ice "ice" "C_A grows by this part in ten seconds";
    OneSided "one_sided" "static moment only of one sign of α";
    CrossDamp "cross_damp" "C_m by r̂, C_n by −q̂";
    RollDrag "roll_drag" "C_A by p̂²";
    Torsion "torsion" "torsion of the line by the roll angle, N m/rad";
    LagM "lag_m" "part of the static moment that comes late";
    LagMTime "lag_m_time" "how late, s";
    DeadBand "dead_band" "recorded speed moves only after this change, m/s";
    Wavy "wavy" "static moment by sin 6 α_T";
    Edge "edge" "C_A lost and C_N gained beyond an angle";
    EdgeAt "edge_at" "sine of that angle";
    VaneSpeed "vane_speed" "C_l by V/V_trim − 1";
    Pulley "pulley" "pull by its own size and the sign of the line's rate, part";
    Plume "plume" "density lost in a column of warm air, part";
    Parallax "parallax" "Y off by X Y, 1/m";
    YawTone "yaw_tone" "C_n of a tone";
    YawToneHz "yaw_tone_hz" "its frequency";
    Sag "sag" "C_m that comes within four seconds and stays";
    WallAt "wall_at" "radius at which a wall is touched, m";
    WallStiff "wall_stiff" "its stiffness, N/m";
    WallDamp "wall_damp" "its damping, N s/m";
    Heating "heating" "temperature rises by this part in ten seconds, recorded";
    AxialBurst "axial_burst" "C_A that flips between two values";
}

/// Values of all.
#[derive(Clone, Debug)]
pub(crate) struct Knobs {
    values: Vec<f64>,
}

impl Default for Knobs {
    fn default() -> Self {
        Self { values: vec![0.0; ALL.len()] }
    }
}

impl Knobs {
    #[inline]
    pub(crate) fn get(&self, k: Knob) -> f64 {
        self.values[k as usize]
    }
    pub(crate) fn set(&mut self, k: Knob, value: f64) {
        self.values[k as usize] = value;
    }
    /// Name and value of all that act.
    pub(crate) fn acting(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        NAMES.iter().zip(&self.values).filter(|(_, v)| v.abs() > 0.0).map(|(n, v)| (*n, *v))
    }
    /// True when one of the given acts.
    pub(crate) fn any(&self, which: &[Knob]) -> bool {
        which.iter().any(|k| self.get(*k).abs() > 0.0)
    }
}
