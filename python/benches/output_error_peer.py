"""Output error with numpy and scipy, beside `windfall identify --method output-error` in the same run.

    cargo build --release && python python/benches/output_error_peer.py CAMPAIGN.toml --windfall target/release/windfall

The usual way: `scipy.optimize.least_squares` (trust region, differences, sparsity of the initial states given) over `solve_ivp`
(RK45, 1e-6), one shot a run. Unknown: the aerodynamic parameters and every run's initial state, weights from the declared sensors.
What is not alike, all in the script's favour: tunnel speed is smoothed once and taken as exact (Windfall estimates it), noise is not
estimated, there are no intervals, and only `--evaluations` evaluations with a Jacobian are timed, which need not be enough to converge.
Both run on one thread; times are processor time, so that other load counts little. Needs a system with `resource` (not Windows).
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import resource
import subprocess
import sys
import time
import tomllib
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_smoothing_spline
from scipy.optimize import least_squares
from scipy.sparse import lil_matrix

NAMES = ["CA_T0", "CN_sin", "CN_sin3", "Cl_0", "Cl_p", "Cm_sin", "Cm_sin3", "Cm_1", "Cm_2", "Cn_1", "Cn_2"]


class Run:
    """One record: time (s), pose (m, rad), tunnel speed and its rate at the samples (m/s, m/s²), density (kg/m³)."""

    def __init__(self, path: Path, gas_constant: float) -> None:
        with path.open() as file:
            rows = list(csv.DictReader(file))
        column = {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if rows[0][key]}
        self.t = column["t_s"] - column["t_s"][0]
        angles = [np.unwrap(np.radians(column[key])) for key in ("Rx_deg", "Ry_deg", "Rz_deg")]
        self.pose = np.array([column["X_m"], column["Y_m"], column["Z_m"], *angles])
        spline = make_smoothing_spline(self.t, column["VW_m_s"])
        self.vw, self.vw_rate = spline(self.t).tolist(), spline.derivative()(self.t).tolist()
        self.density = float(np.mean(column["ps_Pa"] / (gas_constant * column["Ts_K"])))
        self.interval = float(self.t[1])

    def wind(self, t: float) -> tuple[float, float]:
        """Tunnel speed and its rate by linear interpolation."""
        place = min(max(t / self.interval, 0.0), len(self.vw) - 1.001)
        i = int(place)
        f = place - i
        return self.vw[i] + f * (self.vw[i + 1] - self.vw[i]), self.vw_rate[i] + f * (self.vw_rate[i + 1] - self.vw_rate[i])

    def start(self) -> np.ndarray:
        """State at the first sample by a cubic over the first 0.3 s."""
        n = max(8, round(0.3 / self.interval))
        fits = [np.polynomial.Polynomial.fit(self.t[:n], y[:n], 3) for y in self.pose]
        value, rate = np.array([f(0.0) for f in fits]), np.array([f.deriv()(0.0) for f in fits])
        (_, ry, rz), (dx, dy, dz) = value[3:], rate[3:]
        p = dx * math.cos(ry) * math.cos(rz) + dy * math.sin(rz)
        q = dy * math.cos(rz) - dx * math.cos(ry) * math.sin(rz)
        return np.concatenate([value, rate[:3], [p, q, dz + math.sin(ry) * dx]])


def rates(t: float, x: np.ndarray, c: list[float], run: Run, body: dict) -> list[float]:
    """Rates of c.m. position, Euler angles, velocity (tunnel axes) and body rates; thesis Appendix B."""
    px, py, pz, rx, ry, rz, vx, vy, vz, p, q, r = x.tolist()
    sx, cx, sy, cy, sz, cz = math.sin(rx), math.cos(rx), math.sin(ry), math.cos(ry), math.sin(rz), math.cos(rz)
    t00, t01, t02 = cz * cy, -sz * cy, sy
    t10, t11, t12 = cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -cy * sx
    t20, t21, t22 = sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx
    vw, vw_rate = run.wind(t)
    ax, ay, az = vx + vw, vy, vz
    u, v, w = t00 * ax + t10 * ay + t20 * az, t01 * ax + t11 * ay + t21 * az, t02 * ax + t12 * ay + t22 * az
    d, area = body["d"], body["area"]
    across = math.hypot(v, w)
    speed = math.sqrt(u * u + across * across)
    s = across / speed
    sin_phi, cos_phi = (v / across, w / across) if across > 0.0 else (0.0, 1.0)
    pressure = 0.5 * run.density * speed * speed
    normal = c[1] * s + c[2] * s**3
    fx, fy, fz = -pressure * area * c[0] * u / speed, -pressure * area * normal * sin_phi, -pressure * area * normal * cos_phi
    # The tether pulls from the hook to the ring.
    dx, dy, dz = body["ring"][0] - px, body["ring"][1] - py, body["ring"][2] - pz
    hx, hy, hz = body["hook"]
    lx = t00 * dx + t10 * dy + t20 * dz - hx
    ly = t01 * dx + t11 * dy + t21 * dz - hy
    lz = t02 * dx + t12 * dy + t22 * dz - hz
    pull = (pressure * body["drag_area"] - body["weight"]) / math.sqrt(lx * lx + ly * ly + lz * lz)
    gx, gy, gz = pull * lx, pull * ly, pull * lz
    fx, fy, fz = fx + gx, fy + gy, fz + gz
    m = body["mass"]
    ax = (t00 * fx + t01 * fy + t02 * fz) / m + body["gravity"]
    ay = (t10 * fx + t11 * fy + t12 * fz) / m
    az = (t20 * fx + t21 * fy + t22 * fz) / m
    bx = ax + vw_rate
    ud = t00 * bx + t10 * ay + t20 * az - (q * w - r * v)
    vd = t01 * bx + t11 * ay + t21 * az - (r * u - p * w)
    wd = t02 * bx + t12 * ay + t22 * az - (p * v - q * u)
    uw2 = u * u + w * w
    alpha_rate = (u * wd - ud * w) / uw2
    beta_rate = (vd - v * (u * ud + v * vd + w * wd) / speed**2) / math.sqrt(uw2)
    pitch, yaw = (q + alpha_rate) * 0.25 * d / speed, (r - beta_rate) * 0.25 * d / speed
    alpha, beta = math.atan2(w, u), math.asin(v / speed)
    static = c[5] * s + c[6] * s**3
    qsd = pressure * area * d
    l = qsd * (c[3] + c[4] * p * 0.5 * d / speed) + hy * gz - hz * gy
    mm = qsd * (static * cos_phi + (c[7] + c[8] * alpha**2) * pitch) + hz * gx - hx * gz
    n = qsd * (-static * sin_phi + (c[9] + c[10] * beta**2) * yaw) + hx * gy - hy * gx
    ixx, iyy, izz = body["inertia"]
    rx_rate = (p * cz - q * sz) / cy
    return [
        vx, vy, vz, rx_rate, p * sz + q * cz, r - sy * rx_rate, ax, ay, az,
        (l - (izz - iyy) * q * r) / ixx, (mm - (ixx - izz) * p * r) / iyy, (n - (iyy - ixx) * p * q) / izz,
    ]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign", type=Path)
    parser.add_argument("--windfall", type=Path, required=True, help="the program to time beside")
    parser.add_argument("--evaluations", type=int, default=2, help="least_squares' max_nfev")
    args = parser.parse_args()
    campaign = tomllib.loads(args.campaign.read_text())
    vehicle, tether, sensors = campaign["vehicle"], campaign["tether"], campaign["sensors"]
    if any(vehicle["center_of_mass_m"]) or any(vehicle["inertia_kg_m2"][k] for k in ("xy", "xz", "yz")):
        raise SystemExit("this script leaves out an offset centre of mass and products of inertia")
    d = vehicle["reference_diameter_m"]
    body = {
        "mass": vehicle["mass_kg"], "inertia": [vehicle["inertia_kg_m2"][k] for k in ("xx", "yy", "zz")], "d": d,
        "area": math.pi * d * d / 4.0, "hook": tether["attachment_m"], "ring": tether["ring_m"],
        "drag_area": tether["drag_area_m2"], "weight": tether["effective_weight_n"],
        "gravity": campaign["environment"]["gravity_m_s2"],
    }  # fmt: skip
    used = [entry["file"] for entry in campaign["run"] if entry["use"] == "identify"]
    runs = [Run(args.campaign.parent / file, campaign["environment"]["gas_constant_j_kg_k"]) for file in used]
    seconds = sum(float(run.t[-1]) for run in runs)
    a, b = math.radians(sensors["roll_std_deg"]), math.radians(sensors["pitch_yaw_std_deg"])
    std = np.array([sensors["position_std_m"]] * 3 + [a, b, b])
    scale = np.array([abs(campaign["aero"]["axisymmetric"][name]) for name in NAMES])
    flights = 0

    def residuals(theta: np.ndarray) -> np.ndarray:
        nonlocal flights
        out = []
        for i, run in enumerate(runs):
            start = theta[11 + 12 * i : 23 + 12 * i]
            c = (theta[:11] * scale).tolist()
            y = solve_ivp(rates, (0.0, run.t[-1]), start, t_eval=run.t, args=(c, run, body), rtol=1e-6, atol=1e-8).y
            flights += 1
            out.append(((run.pose - y[:6]) / std[:, None]).ravel())
        return np.concatenate(out)

    first = np.concatenate([[campaign["aero"]["axisymmetric"][name] for name in NAMES] / scale, *[run.start() for run in runs]])
    sizes = [6 * len(run.t) for run in runs]
    pattern = lil_matrix((sum(sizes), len(first)), dtype=int)
    row = 0
    for i, size in enumerate(sizes):
        pattern[row : row + size, :11] = 1
        pattern[row : row + size, 11 + 12 * i : 23 + 12 * i] = 1
        row += size
    command = [str(args.windfall), "identify", str(args.campaign), "--method", "output-error", "--combined", "--json", "--quiet", "--threads", "1"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    own = children.ru_utime + children.ru_stime
    began = time.process_time()
    found = least_squares(residuals, first, jac_sparsity=pattern, max_nfev=args.evaluations, x_scale="jac")
    peer = time.process_time() - began
    rms = math.sqrt(2.0 * found.cost / sum(sizes))
    print(f"{seconds:.0f} s of data in {len(runs)} runs; python {sys.version.split()[0]}, numpy {np.__version__}")
    print(f"windfall, reading included, to the end: {own:.2f} s")
    print(f"scipy, {found.nfev} evaluations and {found.njev} Jacobians ({flights} flights): {peer:.2f} s; {found.message}")
    print(f"scipy's weighted residual so far: {rms:.2f} (1 is noise)")
    print(f"ratio: {peer / own:.0f}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
