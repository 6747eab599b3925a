"""Chooses the peers' levels on their own flights: the least at which one campaign in twenty gets a false name.

Calm: clean campaigns with noise of several sizes and colours. Gusty: campaigns with gusts and nothing else. Writes levels.json.
"""
import argparse
import json
import tempfile

import numpy as np
import simulate
from peers.random_loads import excess
from peers.regression import LEVELS, RULES
from peers.shape_free import GaussianProcess, Polynomial
from problem import Problem

QUANTILE = 0.95
GRID = {"stepwise": np.geomspace(4, 3000, 60), "SINDy, polynomials": np.geomspace(1, 100, 50)}
USUAL = np.geomspace(1, 100, 60)


def dryden(rng, runs, rms, length, speed):
    """Gusts of Dryden's axial form in three directions, as a sum of waves."""
    hz = np.geomspace(0.03, 8, 40)
    time = length / speed
    size = rms * np.sqrt(2 * 4 * time / (1 + (2 * np.pi * time * hz) ** 2) * np.gradient(hz))
    phase = rng.uniform(0, 2 * np.pi, (runs, 3, len(hz)))
    return lambda t: (size * np.sin(2 * np.pi * hz * t + phase)).sum(axis=2)


def campaign(folder, i, gusty, rng):
    veh, theta = simulate.draw_vehicle(rng, 0.0 if i % 2 else 0.3)
    gusts = dryden(rng, len(simulate.PLAN), rng.uniform(0.05, 0.12), rng.choice([0.15, 0.3, 0.6, 1.2]), 7.5) if gusty else None
    records = simulate.fly(veh, theta, {}, rng, seconds=rng.uniform(12, 22), gusts=gusts)
    gain, colour = (1.0, 0.0) if gusty or i % 3 else (rng.uniform(0.5, 2), rng.choice([0.0, 0.5, 0.9]))
    simulate.write(folder, "own", veh, simulate.noisy(records, rng, gain, colour))
    return Problem(f"{folder}/own/campaign.toml")


def loudness(rng, flights=8, draws=8):
    """Largest of the six ratios of residual to noise, on clean campaigns with white noise; each flight has several draws of noise."""
    out = []
    for i in range(flights):
        veh, theta = simulate.draw_vehicle(rng, 0.0 if i % 2 else 0.3)
        records = simulate.fly(veh, theta, {}, rng, seconds=rng.uniform(12, 22))
        for _ in range(draws):
            with tempfile.TemporaryDirectory() as folder:
                simulate.write(folder, "own", veh, simulate.noisy(records, rng))
                problem = Problem(f"{folder}/own/campaign.toml", library=False)
            out.append(float(excess(problem.before, problem.noise).max()))
    return out


def silent(rule, problem, grid):
    """Least level of the grid at which nothing is named, by halving."""
    low, high = -1, len(grid) - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if len(rule(problem, grid[middle])) else (low, middle)
    return float(grid[high])


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--calm", type=int, default=20)
    p.add_argument("--gusty", type=int, default=12)
    p.add_argument("--seed", type=int, default=20)
    p.add_argument("--out", default=LEVELS)
    v = p.parse_args()
    rng = np.random.default_rng(v.seed)
    rules = {**RULES, Polynomial.name: Polynomial({}).chosen}
    found = {name: {"calm": [], "gusty": []} for name in rules}
    loud, ratios = loudness(np.random.default_rng(v.seed + 1)), []
    plan = sorted([(i / v.calm, "calm", i) for i in range(v.calm)] + [(i / v.gusty, "gusty", i) for i in range(v.gusty)])
    for _, kind, i in plan:
        with tempfile.TemporaryDirectory() as folder:
            problem = campaign(folder, i, kind == "gusty", rng)
        for name, rule in rules.items():
            found[name][kind].append(silent(rule, problem, GRID.get(name, USUAL)))
        if kind == "calm":
            ratios.append(GaussianProcess({}).ratio(problem)[1])
        print(kind, i, {n: round(f[kind][-1], 1) for n, f in found.items()}, ratios[-1:], flush=True)
        write(v, found, loud, ratios)


def write(v, found, loud, ratios):
    out = {n: {k: float(np.quantile(x, QUANTILE)) for k, x in f.items() if x} for n, f in found.items()}
    out |= {"excess": float(np.quantile(loud, QUANTILE)), GaussianProcess.name: float(np.quantile(ratios, 1 - QUANTILE))}
    counts = {k: len(found["stepwise"][k]) for k in ("calm", "gusty")}
    out["chosen on"] = {**counts, "seed": v.seed, "quantile": QUANTILE}
    with open(v.out, "w") as f:
        json.dump(out, f, indent=1)


if __name__ == "__main__":
    main()
