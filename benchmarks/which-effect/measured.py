"""Measured flights of balls: Windfall beside peers that choose from a library of accelerations, by the error of held-out flights.

A track's second integral is compared, x = x0 + v0 t + sum of theta * (double integral of a term along the smoothed track): position
noise stays position noise. Held out: each flight is integrated with the terms found, its own start fitted, nothing else.
"""
import csv
import math
import pathlib
import time
import tomllib
import warnings

import numpy as np
import pysindy
from peers.windfall import close
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import least_squares
from sklearn.linear_model import LassoLarsIC

LEAST_F = 20.0  # the cut that SIDPAC's manual advises for stepwise regression
DEGREE = 5
STEP_S = 0.005


class Flight:
    def __init__(self, t, x, inputs, held_out):
        self.inputs, self.held_out = inputs, held_out
        self.t, self.x = without_outliers(t - t[0], x)
        centre = (2 * self.t / self.t[-1]) - 1
        fits = [np.polynomial.Chebyshev.fit(centre, c, DEGREE) for c in self.x.T]
        scale = 2 / self.t[-1]
        self.fine = np.linspace(0, self.t[-1], 400)
        at = 2 * self.fine / self.t[-1] - 1
        self.v = np.stack([scale * f.deriv()(at) for f in fits], axis=1)


def without_outliers(t, x):
    """Without samples beyond six robust deviations from a polynomial of the rest (a bounce in the last frame)."""
    keep = np.ones(len(t), bool)
    for _ in range(3):
        left = np.stack([c - np.polynomial.Polynomial.fit(t[keep], c[keep], DEGREE)(t) for c in x.T], axis=1)
        keep = (abs(left) < 6 * 1.4826 * np.median(abs(left[keep]), axis=0)).all(axis=1)
    return t[keep], x[keep]


def read(path):
    raw = tomllib.loads(pathlib.Path(path).read_text())
    if raw["axes"]["down"] != "-Z" or "mass_kg" not in raw["vehicle"]:
        raise ValueError(f"{path}: tracks of a point mass with Z up are read")
    flights = []
    for run in raw["run"]:
        rows = list(csv.DictReader(open(pathlib.Path(path).parent / run["file"])))
        names = [n for n in ("X_m", "Y_m", "Z_m") if n in rows[0]]
        table = np.array([[float(r[n]) for n in ("t_s", *names)] for r in rows])
        flights.append(Flight(table[:, 0], table[:, 1:], run.get("inputs", {}), run["use"] == "hold-out"))
    declared = raw["aero"]["point_mass"]
    return flights, raw["environment"]["gravity_m_s2"], [] if declared.get("declared") == [] else ["drag"]


def terms(flights):
    """Accelerations of the library by name, functions of velocity (n, d) and inputs; Z is the last axis."""
    axes = flights[0].x.shape[1]
    speed = lambda v: np.linalg.norm(v, axis=1, keepdims=True)
    out = {"drag": lambda v, i: -speed(v) * v, "viscous drag": lambda v, i: -v}
    for k in range(axes):
        out[f"constant-acceleration {'XYZ'[3 - axes + k]}"] = lambda v, i, k=k: np.eye(axes)[k] + 0 * v
    if axes == 3:
        up = np.array([0, 0, 1.0])
        side = lambda v: np.cross(v, up) / np.linalg.norm(np.cross(v, up), axis=1, keepdims=True)
        lift = lambda v: speed(v) * np.cross(side(v), v)
        out |= {"spin-lift": lambda v, i: lift(v), "spin-lift side": lambda v, i: speed(v) ** 2 * side(v)}
        spread = {n: max(abs(f.inputs[n]) for f in flights) for n in flights[0].inputs}
        for n, s in spread.items():
            out[f"drag by {n}"] = lambda v, i, n=n, s=s: -speed(v) * v * i[n] / s
            out[f"spin-lift by {n}"] = lambda v, i, n=n, s=s: lift(v) * i[n] / s
            out[f"spin-lift side by {n}"] = lambda v, i, n=n, s=s: speed(v) ** 2 * side(v) * i[n] / s
    return out


def integral_form(flights, gravity, library):
    """Target and columns with each flight's start taken out."""
    blocks = []
    for f in flights:
        down = np.zeros(f.x.shape[1])
        down[-1] = -gravity / 2
        parts = [f.x - f.t[:, None] ** 2 * down]
        for term in library.values():
            twice = cumulative_trapezoid(cumulative_trapezoid(term(f.v, f.inputs), f.fine, axis=0, initial=0), f.fine, axis=0, initial=0)
            parts.append(np.stack([np.interp(f.t, f.fine, c) for c in twice.T], axis=1))
        q = np.linalg.qr(np.stack([np.ones_like(f.t), f.t], axis=1))[0]
        blocks.append(np.stack([(p - q @ (q.T @ p)).ravel() for p in parts]))
    a = np.concatenate(blocks, axis=1)
    return a[0], a[1:].T


def fit(y, a, places):
    b, *_ = np.linalg.lstsq(a[:, places], y, rcond=None) if places else (np.zeros(0),)
    rss = float(((y - a[:, places] @ b) ** 2).sum())
    cov = np.linalg.pinv(a[:, places].T @ a[:, places]) * rss / max(1, len(y) - len(places)) if places else np.zeros((0, 0))
    return b, rss, abs(b) / np.sqrt(np.maximum(np.diag(cov), 1e-300))


def stepwise(y, a, kept):
    chosen = list(kept)
    while len(chosen) < a.shape[1]:
        rss = fit(y, a, chosen)[1]
        new, j = min((fit(y, a, chosen + [j])[1], j) for j in range(a.shape[1]) if j not in chosen)
        if (rss - new) / (new / (len(y) - len(chosen) - 1)) < LEAST_F:
            break
        chosen.append(j)
    return chosen


def scaled(y, a):
    """Columns of unit length and a target in standard deviations of what the whole library leaves."""
    everything = fit(y, a, list(range(a.shape[1])))[1]
    return y / math.sqrt(everything / len(y)), a / np.linalg.norm(a, axis=0)


def sindy(y, a, kept):
    y, a = scaled(y, a)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        b = np.ravel(pysindy.STLSQ(threshold=math.sqrt(LEAST_F), alpha=0.05, max_iter=30).fit(a, y[:, None]).coef_)
    return sorted({*kept, *map(int, np.flatnonzero(b))})


def lasso(y, a, kept):
    y, a = scaled(y, a)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        b = LassoLarsIC(criterion="bic", fit_intercept=False).fit(a * math.sqrt(len(y)), y).coef_
    chosen = sorted({*kept, *map(int, np.flatnonzero(b))})
    while True:
        t = fit(y, a, chosen)[2]
        weak = [(x, j) for x, j in zip(t, chosen) if j not in kept and x * x < LEAST_F]
        if not weak:
            return chosen
        chosen.remove(min(weak)[1])


def constant(names):
    """The decoy: a constant acceleration, whatever the data say."""
    return lambda y, a, kept: list(kept) + [j for j, n in enumerate(names) if n.startswith("constant")]


def fly(flight, gravity, model, start):
    """Positions at the samples from a start, by fourth-order Runge-Kutta."""
    d = flight.x.shape[1]
    down = np.zeros(d)
    down[-1] = -gravity
    grid = np.linspace(0, flight.t[-1], max(2, math.ceil(flight.t[-1] / STEP_S)) + 1)
    h = grid[1]
    acceleration = lambda v: down + sum(b * term(v[None], flight.inputs)[0] for b, term in model)
    rate = lambda s: np.concatenate([s[d:], acceleration(s[d:])])
    states = [np.asarray(start)]
    for _ in grid[1:]:
        s = states[-1]
        k1 = rate(s)
        k2 = rate(s + h / 2 * k1)
        k3 = rate(s + h / 2 * k2)
        states.append(s + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(s + h * k3)))
    out = np.array(states)
    return np.stack([np.interp(flight.t, grid, c) for c in out[:, :d].T], axis=1)


def error(flights, gravity, model):
    """rms over all samples and axes of held-out flights, m."""
    square, count = 0.0, 0
    for f in flights:
        guess = np.concatenate([f.x[0], f.v[0]])
        best = least_squares(lambda s: (fly(f, gravity, model, s) - f.x).ravel(), guess, x_scale=np.maximum(abs(guess), 0.1))
        square, count = square + (best.fun**2).sum(), count + f.x.size
    return math.sqrt(square / count)


def compare(path):
    """Rows (method, terms chosen, held-out error in m, processor seconds) of one set."""
    flights, gravity, declared = read(path)
    library = terms(flights)
    names = list(library)
    own, held = [f for f in flights if not f.held_out], [f for f in flights if f.held_out]
    y, a = integral_form(own, gravity, library)
    kept = [names.index(d) for d in declared]
    rows = []
    rules = {"declared": lambda y, a, kept: list(kept), "constant acceleration": constant(names), "SINDy": sindy, "stepwise": stepwise, "LASSO, BIC": lasso}
    for name, rule in rules.items():
        start = time.process_time()
        places = rule(y, a, kept)
        b = fit(y, a, places)[0]
        seconds = time.process_time() - start
        model = [(v, library[names[j]]) for v, j in zip(b, places)]
        rows.append((name, [names[j] for j in places], error(held, gravity, model), seconds))
    return rows


def windfall(exe, path, work):
    """Windfall's row, or why there is none."""
    result, meta = close(exe, path, pathlib.Path(work) / "-".join(pathlib.Path(path).with_suffix("").parts[-2:]), 600)
    if result is None:
        return "Windfall", [meta["words"].strip()[:120]], None, meta["seconds"]
    named = [e["family"] for e in result["effects"]] or [result["verdict"]]
    after = (result["after"].get("hold_out") or {}).get("position_rms_m")
    return "Windfall", named, after, meta["seconds"]


def tables(folders, exe, work):
    """Markdown: balls with peers, then all other sets with Windfall alone."""
    files = sorted(f for folder in folders for f in pathlib.Path(folder).rglob("*.toml") if f.name != "body.toml")
    lines = ["| set | method | terms beside gravity | held out, mm rms | s |", "|---|---|---|---|---|"]
    others = ["| set | Windfall | held out, before -> after | s |", "|---|---|---|---|"]
    seen = set()
    for f in files:
        label = f.parent.name if f.stem == "campaign" else f"{f.parent.name}, {f.stem}"
        if label in seen or "[[run]]" not in f.read_text():
            continue
        seen.add(label)
        if f.parent.name in ("ball-drops", "table-tennis"):
            for name, chosen, rms, s in [*compare(f), windfall(exe, f, work)]:
                lines.append(f"| {label} | {name} | {', '.join(chosen) or '-'} | {'-' if rms is None else f'{1e3 * rms:.2f}'} | {s:.2f} |")
        else:
            others.append(other(exe, f, work, label))
    return "\n".join([*lines, "", *others])


def other(exe, path, work, label):
    name = "-".join(pathlib.Path(path).with_suffix("").parts[-2:])
    result, meta = close(exe, path, pathlib.Path(work) / name, 600)
    if result is None:
        words = meta["words"].strip().replace(str(path), path.name)
        return f"| {label} | refused: {words[:120]} | - | {meta['seconds']:.1f} |"
    named = result["verdict"] + (": " + ", ".join(e["family"] for e in result["effects"]) if result["effects"] else "")
    sides = [(result[k].get("hold_out") or {}) for k in ("before", "after")]
    size = lambda h: h.get("position_rms_m") or (h.get("specific_force_rms") or [None])[0]
    unit = "m" if sides[0].get("position_rms_m") else "m/s2"
    held = f"{size(sides[0]):.3g} -> {size(sides[1]):.3g} {unit}" if size(sides[0]) and size(sides[1]) else "-"
    return f"| {label} | {named} | {held} | {meta['seconds']:.1f} |"
