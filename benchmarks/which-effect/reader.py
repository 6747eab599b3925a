"""Campaign file and run files in; uniform segments, smoothed with two derivatives, out. SI units, angles in rad.

Smoothing is a local polynomial of order 4 (Savitzky and Golay 1964) over 0.3 s. Its second-derivative filter k2 is the second
derivative of a smooth kernel h: what is measured as k2*x is the true acceleration seen through h, so a model's acceleration is put
through h before the two are compared.
"""
import csv
import dataclasses
import math
import pathlib
import tomllib

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_coeffs

HALF_WINDOW_S = 0.15
LONGEST_GAP_S = 0.1
SHORTEST_SEGMENT_S = 3.0
RESIDUAL_RATE_HZ = 15.0
LEAST_NOISE = 1e-4  # m, rad, m/s: a record finer than this has no outliers to find by its own scatter
CHANNELS = ("X_m", "Y_m", "Z_m", "Rx_deg", "Ry_deg", "Rz_deg", "VW_m_s")


@dataclasses.dataclass
class Vehicle:
    """Declared constants; `sigma` has their stated standard uncertainties by the name of the knob that moves them."""

    mass: float
    inertia: np.ndarray
    cm: np.ndarray
    diameter: float
    hook: np.ndarray
    ring: np.ndarray
    drag_area: float
    line_weight: float
    gravity: float
    gas_constant: float
    sigma: dict

    @property
    def area(self):
        return math.pi * self.diameter**2 / 4


@dataclasses.dataclass
class Segment:
    """One stretch of a run without gaps. Arrays over samples: `e`, `x`, `vw` and their derivatives `e1`, `e2`, ..."""

    run: str
    number: int
    held_out: bool
    dt: float
    t: np.ndarray
    x: list
    e: list
    vw: list
    rho: np.ndarray
    kernel: np.ndarray
    noise_gain: float
    noise: np.ndarray

    def lowpass(self, a):
        """Columns seen through the smooth kernel, thinned to the rate of residuals."""
        out = np.stack([np.convolve(c, self.kernel, "valid") for c in a.T], axis=1)
        return out[:: self.step]

    def thin(self, a):
        m = len(self.kernel) // 2
        return a[m : len(a) - m][:: self.step]

    @property
    def step(self):
        return max(1, round(1 / (self.dt * RESIDUAL_RATE_HZ)))


def kernels(dt):
    """Filters for value, first and second derivative, and the smooth kernel h, as they are given to np.convolve."""
    m = max(4, round(HALF_WINDOW_S / dt))
    k = [savgol_coeffs(2 * m + 1, 4, deriv=d, delta=dt) for d in range(3)]
    h = np.cumsum(np.cumsum(k[2])) * dt * dt
    return k, np.roll(h, 1)[1:-1]


def rotation(e):
    """Body to tunnel, Rx Ry Rz, for Euler angles (n, 3)."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(e).T, np.cos(e).T
    rows = [
        [cy * cz, -cy * sz, sy],
        [cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -cy * sx],
        [sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def vehicle(raw):
    """Declared constants of a lander's campaign."""
    v, t, e = raw["vehicle"], raw["tether"], raw["environment"]
    i = {k: v["inertia_kg_m2"].get(k, 0.0) for k in ("xx", "yy", "zz", "xy", "xz", "yz")}
    inertia = np.array([[i["xx"], -i["xy"], -i["xz"]], [-i["xy"], i["yy"], -i["yz"]], [-i["xz"], -i["yz"], i["zz"]]])
    return Vehicle(
        v["mass_kg"], inertia, np.array(v.get("center_of_mass_m", [0.0] * 3)), v["reference_diameter_m"],
        np.array(t["attachment_m"]), np.array(t["ring_m"]), t["drag_area_m2"], t["effective_weight_n"],
        e["gravity_m_s2"], e["gas_constant_j_kg_k"], uncertainties(raw.get("uncertainty", {})),
    )


def uncertainties(u):
    """Stated standard uncertainties by knob."""
    out = {}
    v, t, s = (u.get(k, {}) for k in ("vehicle", "tether", "sensors"))
    out["mass.mass_kg"] = v.get("mass_kg", 0.0)
    out |= {f"inertia.{k}_kg_m2": x for k, x in v.get("inertia_kg_m2", {}).items()}
    for knob, table, key in (("center-of-mass", v, "center_of_mass_m"), ("hook", t, "attachment_m"), ("ring", t, "ring_m")):
        out |= {f"{knob}.{a}_m": x for a, x in zip("xyz", table.get(key, []))}
    angle = s.get("pose_misalignment_deg", 0.0)
    angle = angle if isinstance(angle, list) else [angle] * 3
    out |= {f"pose-misalignment.{a}_rad": math.radians(x) for a, x in zip("xyz", angle)}
    out["wind-scale.scale"] = s.get("wind_scale", 0.0)
    out["length-scale.scale"] = s.get("length_scale", 0.0)
    out["time-base.rate"] = s.get("time_base", 0.0)
    out["tether-geometry.drag_m2"] = t.get("drag_area_m2", 0.0)
    out["tether-geometry.weight_n"] = t.get("effective_weight_n", 0.0)
    return {k: x for k, x in out.items() if x > 0}


def read(path):
    """Vehicle and segments of a campaign file."""
    path = pathlib.Path(path)
    raw = tomllib.loads(path.read_text())
    if "columns" in raw or "tether" not in raw or "inertia_kg_m2" not in raw["vehicle"]:
        raise ValueError(f"{path}: the reader takes tethered landers in the project's own columns")
    segments = []
    for number, run in enumerate(raw["run"]):
        table = columns(path.parent / run["file"])
        if "window_s" in run:
            a, b = run["window_s"]
            table = table[(table[:, 0] >= a) & (table[:, 0] <= b)]
        segments += cut(run["file"], number, run["use"] == "hold-out", table, raw["environment"]["gas_constant_j_kg_k"])
    return vehicle(raw), segments


def columns(path):
    """Rows of t, seven measured channels (angles in rad, roll unwrapped) and air density terms p_s and T_s."""
    with open(path, newline="") as f:
        head = next(lines := csv.reader(f))
        values = np.array([[float(c) if c.strip() else np.nan for c in row] for row in lines])
    at = {name: k for k, name in enumerate(head)}
    a = values[:, [at[n] for n in ("t_s", *CHANNELS, "ps_Pa", "Ts_K")]]
    a = a[np.isfinite(a).all(axis=1)]
    a[:, 4:7] = np.unwrap(np.radians(a[:, 4:7]), axis=0)
    return a


def cut(name, number, held_out, a, gas_constant):
    """Segments between gaps, on an even grid, outliers replaced, smoothed."""
    dt = float(np.median(np.diff(a[:, 0])))
    breaks = np.flatnonzero(np.diff(a[:, 0]) > LONGEST_GAP_S + dt) + 1
    out = []
    for part in np.split(a, breaks):
        if part[-1, 0] - part[0, 0] < SHORTEST_SEGMENT_S:
            continue
        t = np.arange(part[0, 0], part[-1, 0] + dt / 2, dt)
        even = CubicSpline(part[:, 0], part[:, 1:])(np.clip(t, part[0, 0], part[-1, 0]))
        out.append(segment(name, number, held_out, dt, t, *cleaned(even, dt), gas_constant))
    return out


def cleaned(even, dt):
    """Values beyond six robust deviations of the local fit replaced by it, and the noise of each channel above the pass band."""
    (k0, _, _), _ = kernels(dt)
    m, noise = len(k0) // 2, np.zeros(7)
    gain = math.sqrt(1 - 2 * k0[m] + (k0**2).sum())
    for c in range(7):
        for last in (False, False, True):
            left = even[m:-m, c] - np.convolve(even[:, c], k0, "valid")
            noise[c] = 1.4826 * np.median(np.abs(left - np.median(left))) / gain
            if not last:
                bad = np.flatnonzero(np.abs(left) > 6 * gain * max(noise[c], LEAST_NOISE)) + m
                good = np.setdiff1d(np.arange(len(even)), bad)
                even[bad, c] = np.interp(bad, good, even[good, c])
    return even, noise


def segment(name, number, held_out, dt, t, even, noise, gas_constant):
    k, h = kernels(dt)
    m = len(k[0]) // 2
    smooth = [np.stack([np.convolve(c, kernel, "valid") for c in even[:, :7].T], axis=1) for kernel in k]
    rho = even[:, 7] / (gas_constant * even[:, 8])
    return Segment(
        name, number, held_out, dt, t[m:-m], [s[:, :3] for s in smooth], [s[:, 3:6] for s in smooth],
        [s[:, 6] for s in smooth], rho[m:-m], h, float(np.sqrt((k[2] ** 2).sum())), noise,
    )
