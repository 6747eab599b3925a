#!/usr/bin/env python3
"""Is a fall over the turning ellipsoid right, by equations of another kind?

NESC check cases 6, 7 and 8, and a climb from 36 deg N in the shear of case 8, as `windfall simulate` flies them and in inertial axes by
SciPy's DOP853 at 1e-13, with its own J2 gravity, US Standard Atmosphere 1976 (troposphere) and geodetic coordinates.

  scripts/planet_inertial.py PROGRAM     needs numpy and scipy; exit code 1 beyond 1e-3 m or 1e-5 m/s
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
from scipy.integrate import solve_ivp

SCENARIOS = pathlib.Path(__file__).resolve().parent.parent / "scenarios" / "planet"
MU, RADIUS, FLATTENING, J2, OMEGA = 3.986004418e14, 6378137.0, 1 / 298.257223563, 1.08262982e-3, 7.292115e-5
E2 = FLATTENING * (2 - FLATTENING)
FOOT, MASS, AREA, CD = 0.3048, 14.593902937206, 0.01824146545248, 0.1
SPIN = np.array([0.0, 0.0, OMEGA])
# Wind toward the east over height, m/s; latitude and longitude in deg, height in m, velocity over the ground in m/s (north, east, down).
DROP, CLIMB = (0.0, 0.0, 9144.0, (0.0, 0.0, 0.0)), (36.02, -75.67, 3000.0, (120.0, -80.0, -50.0))
SHEAR = lambda h: (0.003 * h / FOOT - 20) * FOOT
CASES = [("nesc-06", DROP, lambda h: 0.0), ("nesc-07", DROP, lambda h: 20 * FOOT), ("nesc-08", DROP, SHEAR), ("nesc-08", CLIMB, SHEAR)]


def density(h):
    geopotential = 6356766.0 * h / (6356766.0 + h)
    t, gas = 288.15 - 6.5e-3 * geopotential, 8314.32 / 28.9644
    return 101325.0 * (t / 288.15) ** (9.80665 / (gas * 6.5e-3)) / (gas * t)


def gravity(r):
    n = np.linalg.norm(r)
    z2, k = (r[2] / n) ** 2, 1.5 * J2 * (RADIUS / n) ** 2
    return -MU / n**3 * r * np.array([1 + k * (1 - 5 * z2), 1 + k * (1 - 5 * z2), 1 + k * (3 - 5 * z2)])


def fixed(lat, lon, h):
    n = RADIUS / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    return np.array([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon), (n * (1 - E2) + h) * np.sin(lat)])


def geodetic(x):
    p = np.hypot(x[0], x[1])
    lat = np.arctan2(x[2], p * (1 - E2))
    for _ in range(12):
        n = RADIUS / np.sqrt(1 - E2 * np.sin(lat) ** 2)
        lat = np.arctan2(x[2] + E2 * n * np.sin(lat), p)
    h = p * np.cos(lat) + x[2] * np.sin(lat) - RADIUS * np.sqrt(1 - E2 * np.sin(lat) ** 2)
    return lat, np.arctan2(x[1], x[0]), h


def ned(lat, lon):
    sl, cl, so, co = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    return np.array([[-sl * co, -sl * so, cl], [-so, co, 0], [-cl * co, -cl * so, -sl]])


def turned(t):
    c, s = np.cos(OMEGA * t), np.sin(OMEGA * t)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def flight(start, wind, seconds):
    lat, lon, height, velocity = np.radians(start[0]), np.radians(start[1]), start[2], np.array(start[3])
    x = fixed(lat, lon, height)

    def rates(t, y):
        r, v, to_fixed = y[:3], y[3:], turned(t)
        la, lo, h = geodetic(to_fixed @ r)
        air = to_fixed @ (v - np.cross(SPIN, r)) - ned(la, lo).T @ np.array([0.0, wind(h), 0.0])
        return np.concatenate([v, gravity(r) - to_fixed.T @ (0.5 * density(h) * CD * AREA / MASS * np.linalg.norm(air) * air)])

    y = np.concatenate([x, ned(lat, lon).T @ velocity + np.cross(SPIN, x)])
    return solve_ivp(rates, (0, seconds), y, method="DOP853", rtol=1e-13, atol=1e-9, dense_output=True).sol


def simulated(program, name, start, folder):
    """truth.csv of a bundled scenario, from another start."""
    text = (SCENARIOS / f"{name}.toml").read_text()
    said = {"latitude_deg": start[0], "longitude_deg": start[1], "height_m": start[2], "velocity_ned_m_s": list(start[3])}
    for key, value in said.items():
        text = re.sub(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
    for table in SCENARIOS.glob("*.csv"):
        (folder / table.name).write_bytes(table.read_bytes())
    (folder / "case.toml").write_text(text)
    subprocess.run([program, "simulate", str(folder / "case.toml"), "--out", str(folder / "out"), "--quiet"], check=True)
    with open(folder / "out" / "truth.csv") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def main():
    good = True
    for name, start, wind in CASES:
        with tempfile.TemporaryDirectory() as folder:
            rows = simulated(sys.argv[1], name, start, pathlib.Path(folder))
        at, worst = flight(start, wind, rows[-1]["t_s"]), np.zeros(3)
        for row in rows:
            y, to_fixed = at(row["t_s"]), turned(row["t_s"])
            x = to_fixed @ y[:3]
            lat, lon, h = geodetic(x)
            v = ned(lat, lon) @ (to_fixed @ (y[3:] - np.cross(SPIN, y[:3])))
            there = fixed(np.radians(row["latitude_deg"]), np.radians(row["longitude_deg"]), row["altitude_m"])
            apart = [abs(h - row["altitude_m"]), np.linalg.norm(there - x), np.linalg.norm(v - [row[f"v_{a}_m_s"] for a in ("north", "east", "down")])]
            worst = np.maximum(worst, apart)
        good &= bool(worst[0] < 1e-3 and worst[1] < 1e-3 and worst[2] < 1e-5)
        print(f"{name} from {start[2]:.0f} m at {start[0]} deg, {rows[-1]['t_s']:.0f} s: altitude {worst[0]:.1e} m, position {worst[1]:.1e} m, velocity {worst[2]:.1e} m/s")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
