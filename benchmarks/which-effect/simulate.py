"""The peers' own flights: campaigns of the declared model (and, for tests, with effects) from the reader's equations of motion.

Fourth-order Runge-Kutta at the sampling rate over all runs of a campaign at once. Used to choose the peers' thresholds and by the
tests; the campaigns that methods are scored on come from other simulators.
"""
import json
import math
import pathlib

import numpy as np
from lander import PARAMETERS, Knobs, euler_to_rates, loads, turn
from reader import Vehicle, rotation

RATE_HZ = 100.0
SAGE = (6.662, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.43, -3.3025, -205.43, -2.0655, 2.5278)
SIGMA = np.array([7.5e-4, 7.5e-4, 7.5e-4, math.radians(0.0623), math.radians(0.11), math.radians(0.11), 2.57e-3])
PLAN = (("perturbed-1", "identify"), ("perturbed-2", "identify"), ("unperturbed-1", "identify"), ("perturbed-3", "hold-out"), ("unperturbed-2", "hold-out"))


def draw_vehicle(rng, spread):
    """A lander about the thesis' one; each number off by up to `spread` of itself."""
    f = lambda: rng.uniform(1 - spread, 1 + spread)
    veh = Vehicle(
        0.7873 * f(), np.diag([0.02113, 0.0138, 0.01379]) * f(), np.zeros(3), 0.2125 * f(), np.array([-0.25 * f(), 0.0, 0.0]),
        np.array([-3.0 * f(), 0.0, 0.0]), 0.0013006426 * f(), 0.01645842 * f(), 9.80665, 287.05287, {},
    )
    theta = np.array([p * f() for p in SAGE])
    theta[9:] = theta[[7, 8, 5, 6]]
    return veh, theta


def fly(veh, theta, knobs, rng, runs=len(PLAN), seconds=20.0, gusts=None):
    """Records (runs, samples, t and seven channels, no noise). `gusts`: function of time to velocities (runs, 3), m/s."""
    k = Knobs(knobs)
    rho, n = 101325 / (287.05287 * 299.0), round(seconds * RATE_HZ)
    trim = math.sqrt(2 * veh.mass * veh.gravity / (rho * veh.area * theta[0]))
    released = np.array([i not in (2, 4) for i in range(runs)])
    tilt = np.where(released, np.radians(rng.uniform(14, 25, runs)), np.radians(rng.uniform(1, 2.5, runs)))
    clock = rng.uniform(0, 2 * np.pi, runs)
    e = np.stack([rng.uniform(-np.pi, np.pi, runs), tilt * np.cos(clock), tilt * np.sin(clock)], axis=1)
    w = np.stack([rng.uniform(-0.4, 0.4, runs), *(rng.normal(0, 0.05, (2, runs)))], axis=1)
    y = np.concatenate([rng.uniform(-0.2, 0.2, (runs, 3)), rng.normal(0, 0.02, (runs, 3)), e, w, np.full((runs, 1), trim), np.zeros((runs, 1))], axis=1)
    phases = rng.uniform(0, 2 * np.pi, (runs, 3))

    def rate(t, y):
        x, v, e, w, vw, vw1 = y[:, :3], y[:, 3:6], y[:, 6:9], y[:, 9:12], y[:, 12], y[:, 13]
        if gusts:
            k.update({f"gust.{a}": g for a, g in zip("xyz", gusts(t).T)})
        r = rotation(e)
        specific, w1 = loads(veh, theta, k, np.full(runs, t), np.arange(runs), x, r, v, w, vw, vw1, rho)
        wander = 0.04 * np.sin(2 * np.pi * t * np.array([0.07, 0.13, 0.29]) + phases).sum(axis=1)
        wish = trim * (1 + 0.03 * x[:, 0] + 0.06 * v[:, 0]) + wander
        e1 = np.linalg.solve(euler_to_rates(e)[0], w[:, :, None])[:, :, 0]
        return np.concatenate([v, turn(r, specific) + [veh.gravity, 0, 0], e1, w1, vw1[:, None], (9 * (wish - vw) - 6 * vw1)[:, None]], axis=1)

    out, h = np.empty((runs, n, 8)), 1 / RATE_HZ
    for i in range(n):
        t = i * h
        out[:, i, 0], out[:, i, 7] = t, y[:, 12]
        out[:, i, 1:4], out[:, i, 4:7] = y[:, :3] - turn(rotation(y[:, 6:9]), np.broadcast_to(veh.cm, (runs, 3))), y[:, 6:9]
        a = rate(t, y)
        b = rate(t + h / 2, y + h / 2 * a)
        c = rate(t + h / 2, y + h / 2 * b)
        d = rate(t + h, y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
    return out


def noisy(records, rng, gain=1.0, colour=0.0):
    """Records with noise of the thesis' sizes, times `gain`, white or with a correlation from sample to sample."""
    fresh = rng.normal(size=(*records.shape[:2], 7))
    for i in range(1, fresh.shape[1]):
        fresh[:, i] = colour * fresh[:, i - 1] + math.sqrt(1 - colour**2) * fresh[:, i]
    out = records.copy()
    out[:, :, 1:] += gain * SIGMA * fresh
    return out


def write(folder, name, veh, records, family="none", group="own", plan=PLAN):
    """A campaign in the project's own files."""
    root = pathlib.Path(folder) / name
    root.mkdir(parents=True, exist_ok=True)
    diag = dict(zip(("xx", "yy", "zz"), np.diag(veh.inertia)))
    text = [f'[campaign]\nname = "{name}"\n[vehicle]\nmass_kg = {veh.mass}', "inertia_kg_m2 = { " + ", ".join(f"{a} = {v}" for a, v in diag.items()) + ", xy = 0.0, xz = 0.0, yz = 0.0 }"]
    text += ["center_of_mass_m = [0.0, 0.0, 0.0]", f"reference_diameter_m = {veh.diameter}", "[tether]", f"attachment_m = {list(map(float, veh.hook))}"]
    text += [f"ring_m = {list(map(float, veh.ring))}", f"drag_area_m2 = {veh.drag_area}", f"effective_weight_n = {veh.line_weight}", "[environment]", f"gravity_m_s2 = {veh.gravity}"]
    text += [f"gas_constant_j_kg_k = {veh.gas_constant}", "[sensors]\nposition_std_m = 7.5e-4\nroll_std_deg = 0.0623\npitch_yaw_std_deg = 0.110\nwind_std_m_s = 2.57e-3"]
    text += ["[aero.axisymmetric]"] + [f"{n} = {v}" for n, v in zip(PARAMETERS[:11], SAGE)]
    for (run, use), rows in zip(plan, records):
        text.append(f'[[run]]\nfile = "{run}.csv"\nkind = "{run.split("-")[0]}"\nuse = "{use}"')
        table = np.concatenate([rows[:, :4], np.degrees(rows[:, 4:7]), np.full((len(rows), 1), 101325.0), rows[:, 7:], np.full((len(rows), 1), 299.0)], axis=1)
        np.savetxt(root / f"{run}.csv", table, fmt="%.6f", delimiter=",", comments="", header="t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,ps_Pa,VW_m_s,Ts_K")
    (root / "campaign.toml").write_text("\n".join(text) + "\n")
    return {"name": name, "group": group, "what": family, "family": family, "truth": {}}


def answers(folder, rows):
    (pathlib.Path(folder) / "answers.json").write_text(json.dumps(rows, indent=1))
