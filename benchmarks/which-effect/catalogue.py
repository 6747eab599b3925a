"""Candidate effects of the catalogue as columns of first order: what each number, moved from zero, changes in the residual.

A family has strengths (columns) and perhaps a shape (a width, a harmonic, a frequency) of which the best of a grid is taken, on
the runs to identify on. `step` is the half-difference by which a column is formed.
"""
import numpy as np
from lander import Knobs, residual
from scipy.signal import lfilter

FAMILIES = {
    "asymmetry": {"Cm_0": 0.02, "Cn_0": 0.02, "CY_0": 0.02, "CN_0": 0.02},
    "axial-shape": {"CA_sin2": 1.0, "CA_sin4": 1.0},
    "axial-speed": {"CA_speed": 0.5},
    "magnus": {"Cn_p_alpha": 2.0, "CY_p_alpha": 2.0},
    "rate-force": {"CN_q": 2.0},
    "roll-damping-shape": {"Cl_p_sin2": 10.0, "Cl_p_abs_p": 100.0},
    "damping-shape": {"bump": 2.0},
    "roll-periodic": {"Cm_cos": 0.1, "Cm_sin": 0.1},
    "flow-profile": {"bowl_per_m2": 0.02, "tilt_y_per_m": 0.01, "tilt_z_per_m": 0.01},
    "swirl": {"rad_per_m": 0.01},
    "cross-flow": {"y_rad": 0.005, "z_rad": 0.005},
    "tether-line-rate": {"n_s_per_m": 0.2},
    "tether-length": {"per_m": 1.0},
    "tether-geometry": {"pull_excess": 0.5, "weight_excess": 0.5, "ring_y_m": 0.1, "ring_z_m": 0.1},
    "swivel-friction": {"torque_n_m": 1e-4},
    "center-of-mass": {"x_m": 5e-4, "y_m": 5e-4, "z_m": 5e-4},
    "inertia": {"xy_kg_m2": 1e-4, "xz_kg_m2": 1e-4, "yz_kg_m2": 1e-4, "yy_kg_m2": 1e-4},
    "mass": {"mass_kg": 0.01},
    "apparent-mass": {"axial_kg": 0.01, "radial_kg": 0.01, "transverse_kg_m2": 1e-4},
    "wind-scale": {"scale": 0.005},
    "wind-delay": {"delay_s": 0.05},
    "pose-misalignment": {"x_rad": 0.004, "y_rad": 0.004, "z_rad": 0.004},
    "length-scale": {"scale": 0.005},
    "time-base": {"rate": 0.005},
    "loose-mass": {"mass_kg": 0.01},
    "contact": {f"{a}_{x}_n{m}_s": s for a, m, s in (("impulse", "", 0.01), ("angular", "_m", 0.001)) for x in "xyz"},
}
SHAPES = {
    "damping-shape": [{"width_rad": w} for w in (0.05, 0.08, 0.12, 0.18, 0.3)],
    "roll-periodic": [{"harmonic": float(n)} for n in range(1, 7)],
    "loose-mass": [{"frequency_hz": f, "x_cm_m": x} for f in np.geomspace(0.7, 4.0, 13) for x in (-0.1, 0.1)],
}
# A late pose is an early anemometer: one column, told apart by its sign.
OPPOSITE = {"wind-delay": "pose-delay"}
PULSE_S = 0.25
LOOSE_DAMPING = 0.05


def knob(family, name):
    return f"{family}.{name}"


def swinging(veh, k):
    """Accelerations by a part that swings across x on a spring, first order in its mass, driven by the motion of its mount."""
    k = Knobs(k)
    mass, hz, arm = k["loose-mass.mass_kg"], k["loose-mass.frequency_hz"], np.array([k["loose-mass.x_cm_m"], 0.0, 0.0])
    w0, zeta = 2 * np.pi * hz, k["loose-mass.damping_ratio"] or LOOSE_DAMPING

    def inside(seg, specific, w, w1):
        mount = specific + np.cross(w1, arm) + np.cross(w, np.cross(w, arm))
        h = seg.dt
        # Oscillator driven by its mount, bilinear rule: relative place over mount's acceleration.
        c = 2 / h
        den = np.array([c * c + 2 * zeta * w0 * c + w0**2, 2 * w0**2 - 2 * c * c, c * c - 2 * zeta * w0 * c + w0**2])
        off = np.zeros_like(mount)
        off[:, 1:] = lfilter(-np.array([1.0, 2.0, 1.0]) / den[0], den / den[0], mount[:, 1:], axis=0)
        acceleration = np.zeros_like(mount)
        rate = np.gradient(off, h, axis=0)
        acceleration[:, 1:] = -(w0**2) * off[:, 1:] - 2 * zeta * w0 * rate[:, 1:] - mount[:, 1:]
        f = -mass * acceleration
        m = np.cross(arm, f) - mass * np.cross(off, mount)
        return f / veh.mass, m @ np.linalg.inv(veh.inertia).T

    return inside


def left(seg, veh, theta, k):
    """Residual with the effects `k`, a loose mass among them."""
    loose = k and k.get("loose-mass.mass_kg")
    return residual(seg, veh, theta, k, swinging(veh, k) if loose else None)


def column(segs, veh, theta, base, name, step, shape=None):
    """Central difference of the residual by one number, with the sign of a regressor; one array a segment."""
    held = {knob(name.split(".")[0], n): v for n, v in (shape or {}).items()}
    up, down = {**base, **held}, {**base, **held}
    up[name] = up.get(name, 0.0) + step
    down[name] = down.get(name, 0.0) - step
    return [(left(s, veh, theta, down) - left(s, veh, theta, up)) / (2 * step) for s in segs]


def family_columns(segs, veh, theta, base, family, shape=None):
    return {
        knob(family, n): column(segs, veh, theta, base, knob(family, n), step, shape)
        for n, step in FAMILIES[family].items()
    }
