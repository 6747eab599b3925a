"""The noise study as a Python user would write it, beside `windfall.study`: draws per core-second.

In: nothing. Out: both rates and how well both find CA_T0, CN_sin and Cm_2. By hand: `pip install numpy scipy numba`, this package,
then `python study_by_hand.py`. A draw: 15 s of lander_peers.py's flight at 150 Hz, instruments' noise, a zero-phase Butterworth filter
at 3 Hz, central differences, accelerations to coefficients, least squares; no intervals, no tests of the residuals, nothing kept safe,
the tether's force and V_W taken as known. Ours does all that, with everything a `runs.parquet` holds.
"""

import tempfile
import time
from pathlib import Path

import lander_peers as peers
import numba
import numpy as np
import scipy.signal
import windfall
from scipy.spatial.transform import Rotation

H, N, DRAWS = 1 / 150, 2250, 200
POSITION_STD, ROLL_STD, TILT_STD, VW_STD = 7.5e-4, np.radians(0.0623), np.radians(0.110), 2.57e-3
FILTER = scipy.signal.butter(4, 3.0, fs=1 / H, output="sos")


@numba.njit(error_model="numpy")
def fly(y):
    states = np.empty((N + 1, 13))
    states[0] = y
    for n in range(N):
        t = n * H
        k1 = peers.rate_for_scipy(t, y)
        k2 = peers.rate_for_scipy(t + H / 2, y + H / 2 * k1)
        k3 = peers.rate_for_scipy(t + H / 2, y + H / 2 * k2)
        k4 = peers.rate_for_scipy(t + H, y + H * k3)
        y = y + H / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states[n + 1] = y
    return states


def record(states, rng):
    """Position, attitude (Rx, Ry, Rz) and V_W with noise; a row for each sample."""
    q = states[:, [7, 8, 9, 6]]
    angles = Rotation.from_quat(q).as_euler("XYZ")
    t = np.arange(N + 1) * H
    vw = 7.43 + 0.12 * np.sin(0.9 * t) + 0.05 * np.sin(2.3 * t + 1.0) + 0.02 * np.cos(6.1 * t)
    clean = np.column_stack([states[:, :3], angles, vw])
    return clean + rng.normal(size=clean.shape) * [*[POSITION_STD] * 3, ROLL_STD, TILT_STD, TILT_STD, VW_STD]


def identify(x):
    """CA_T0, CN_sin, Cm_2 by least squares on smoothed differences; ends of 1 s dropped."""
    x = scipy.signal.sosfiltfilt(FILTER, x, axis=0)
    r = Rotation.from_euler("XYZ", x[:, 3:6])
    v = np.gradient(x[:, :3], H, axis=0, edge_order=2)
    a = np.gradient(v, H, axis=0, edge_order=2)
    turn = (r[:-2].inv() * r[2:]).as_rotvec() / (2 * H)
    w = np.vstack([turn[:1], turn, turn[-1:]])
    wd = np.gradient(w, H, axis=0, edge_order=2)
    vwd = np.gradient(x[:, 6], H)
    air = r.apply(v + np.outer(x[:, 6], [1, 0, 0]), inverse=True)
    aird = np.gradient(air, H, axis=0)
    speed = np.linalg.norm(air, axis=1)
    ring = r.apply([peers.RING, 0, 0] - x[:, :3], inverse=True) - [peers.HOOK, 0, 0]
    pull = ((0.5 * peers.RHO * speed**2 * peers.DRAG - peers.WEIGHT) / np.linalg.norm(ring, axis=1))[:, None] * ring
    force = peers.MASS * r.apply(a - [peers.G, 0, 0], inverse=True) - pull
    inertia = np.array([peers.IXX, peers.IYY, peers.IZZ])
    moment = inertia * wd + np.cross(w, inertia * w) - np.cross([peers.HOOK, 0, 0], pull)
    qs = 0.5 * peers.RHO * speed**2 * peers.AREA
    sines, hat = air / speed[:, None], 0.5 * peers.D / speed
    lateral = sines[:, 1] ** 2 + sines[:, 2] ** 2
    alpha, beta = np.arctan2(air[:, 2], air[:, 0]), np.arctan2(air[:, 1], np.hypot(air[:, 0], air[:, 2]))
    keep = slice(150, -150)

    def fit(columns, y):
        return np.linalg.lstsq(np.column_stack(columns)[keep], y[keep], rcond=None)[0]

    ca = fit([-sines[:, 0]], force[:, 0] / qs)[0]
    cn = fit([-sines[:, 2], -sines[:, 2] * lateral], force[:, 2] / qs)[0]
    rate = (w[:, 1] + np.gradient(alpha, H)) * 0.5 * hat
    cm = fit([sines[:, 2], sines[:, 2] * lateral, rate, rate * alpha**2], moment[:, 1] / (qs * peers.D))
    return ca, cn, cm[3]


def main():
    fly(peers.start())
    rng = np.random.default_rng(1)
    begin = time.process_time()
    found = np.array([identify(record(fly(peers.start()), rng)) for _ in range(DRAWS)])
    by_hand = DRAWS / (time.process_time() - begin)
    scenario = (Path(__file__).parents[2] / "scenarios/bundled/sage-perturbed.toml").read_text()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "fifteen.toml").write_text(scenario.replace("duration_s = 18.3", "duration_s = 15.0"))
        order = Path(folder, "study.toml")
        head = f'[study]\nname = "noise"\nscenario = "fifteen.toml"\ndraws = {DRAWS}\nseed = 1\n'
        order.write_text(head + '[do]\nidentify = ["equation-error"]\n')
        begin = time.process_time()
        summary = windfall.study(order, Path(folder, "out"), threads=1)
        ours = DRAWS / (time.process_time() - begin)
    print(f"by hand {by_hand:.1f} draws/s a core, windfall {ours:.1f}; ratio {ours / by_hand:.2f}")
    for i, name in enumerate(["CA_T0", "CN_sin", "Cm_2"]):
        truth = {"CA_T0": peers.P[0], "CN_sin": peers.P[1], "Cm_2": peers.P[8]}[name]
        line = next(p for p in summary["parameters"] if p["name"] == name)
        error = found[:, i] - truth
        print(f"{name}: bias, scatter by hand {error.mean():.2e}, {error.std():.2e}; windfall {line['bias']:.2e}, {line['scatter']:.2e}")


if __name__ == "__main__":
    main()
