"""A campaign as a regression that every peer is given: whitened residual of the declared model, columns of the catalogue, and the
declared model's own parameters (with constants of stated uncertainty) taken out of both.
"""
import dataclasses
import time

import numpy as np
from catalogue import FAMILIES, OPPOSITE, PULSE_S, SHAPES, column, family_columns, knob, left
from lander import PARAMETERS, expected_noise
from reader import read

FREE = PARAMETERS[:11]
AR_ORDER = 12
RIVAL_NATS = 3.0
CONTACT_SPACING_S = 0.2
STEPS = {k: s for k, s in (("mass.mass_kg", 1e-3), ("wind-scale.scale", 1e-3), ("length-scale.scale", 1e-3), ("time-base.rate", 1e-3))}


def theta_of(free):
    """Thirteen parameters from eleven: the yaw equation has the pitch equation's static pair."""
    p = dict(zip(FREE, free))
    return np.array([p.get(n, p.get(n.replace("Cn_", "Cm_"))) for n in PARAMETERS])


def declared_columns(segs, veh, base):
    """Residual with no aerodynamics and its columns by the free parameters, exact since they are linear."""
    zero = [left(s, veh, theta_of(np.zeros(11)), base) for s in segs]
    unit = np.eye(11)
    return zero, [[z - left(s, veh, theta_of(u), base) for s, z in zip(segs, zero)] for u in unit]


class Whitener:
    """Autoregression of each channel, learnt from what the whole library leaves."""

    def __init__(self, parts):
        self.filters, self.std = [], []
        for c in range(6):
            lag = max(1, min(AR_ORDER, min(len(p) for p in parts) // 10))
            x = np.concatenate([np.stack([p[lag - j - 1 : len(p) - j - 1, c] for j in range(lag)], axis=1) for p in parts])
            y = np.concatenate([p[lag:, c] for p in parts])
            a = np.linalg.lstsq(x, y, rcond=None)[0]
            self.filters.append(np.concatenate([[1.0], -a]))
            self.std.append(float(np.std(y - x @ a)))
        self.std = np.maximum(self.std, 1e-9)

    def __call__(self, parts):
        return np.concatenate([
            np.convolve(p[:, c], self.filters[c], "valid") / self.std[c] for p in parts for c in range(6)
        ])


@dataclasses.dataclass
class Fit:
    """A set of families fitted to the runs to identify on."""

    families: list
    theta: np.ndarray
    effects: dict
    rss: float
    residuals: list


class Problem:
    """`library=False`: the declared model and held-out error alone."""

    def __init__(self, path, library=True):
        start = time.process_time()
        self.veh, segments = read(path)
        self.segs = [s for s in segments if not s.held_out]
        self.held = [s for s in segments if s.held_out]
        self.noise = np.sqrt(np.mean([expected_noise(s) ** 2 for s in self.segs], axis=0))
        zero, self.declared = declared_columns(self.segs, self.veh, {})
        self.weights = [np.ones((len(z), 6)) / self.noise for z in zero]
        self.theta, self.base = theta_of(self.lstsq(zero, self.declared)), {}
        self.constants = list(self.veh.sigma.items())
        for _ in range(2 if self.constants else 1):
            self.before = [left(s, self.veh, self.theta, self.base) for s in self.segs]
            self.constant_columns = [column(self.segs, self.veh, self.theta, self.base, k, STEPS.get(k, s)) for k, s in self.constants]
            self.settle()
        if library:
            self.make_library()
        self.seconds = time.process_time() - start

    def lstsq(self, target, columns):
        def stack(parts):
            return np.concatenate([(p * w).ravel() for p, w in zip(parts, self.weights)])

        a = np.stack([stack(c) for c in columns], axis=1)
        size = np.maximum(np.linalg.norm(a, axis=0), 1e-12)
        return np.linalg.lstsq(a / size, stack(target), rcond=1e-10)[0] / size

    def settle(self):
        """Constants of stated uncertainty moved to where the declared model fits best, the parameters with them."""
        if not self.constants:
            return
        sigma = np.array([s for _, s in self.constants])
        cols = self.declared + [[c * s for c in parts] for parts, s in zip(self.constant_columns, sigma)]
        rows = lambda parts: np.concatenate([(p * w).ravel() for p, w in zip(parts, self.weights)])
        now = np.array([self.base.get(k, 0.0) for k, _ in self.constants]) / sigma
        prior = np.eye(len(cols))[len(self.declared) :]
        a = np.concatenate([np.stack([rows(c) for c in cols], axis=1), prior])
        step = np.linalg.lstsq(a, np.concatenate([rows(self.before), -now]), rcond=1e-12)[0]
        self.theta = self.theta + theta_of(step[:11])
        self.base = {k: float(x) for (k, _), x in zip(self.constants, (now + step[11:]) * sigma)}
        self.before = [left(s, self.veh, self.theta, self.base) for s in self.segs]

    def make_library(self):
        """Whitens by what all candidates leave, then takes the best shape of each family."""
        raw = {}
        for family in FAMILIES:
            if family != "contact":
                for shape in SHAPES.get(family, [None]):
                    raw[family, str(shape)] = (shape, family_columns(self.segs, self.veh, self.theta, self.base, family, shape))
        every = self.declared + [c for _, cols in raw.values() for c in cols.values()]
        fitted = self.lstsq(self.before, every)
        self.rest = [y - sum(b * c[i] for b, c in zip(fitted, every)) for i, y in enumerate(self.before)]
        self.white = Whitener(self.rest)
        self.nuisance()
        now = [-self.base[k] / s for k, s in self.constants]
        self.target = self.project(self.white(self.before), now)
        self.shapes, self.columns = {}, {}
        for family in FAMILIES:
            options = [v for (f, _), v in raw.items() if f == family]
            if family == "contact":
                options = [self.contact()]
            scored = [(self.gain({n: self.column(c) for n, c in cols.items()}), k) for k, (_, cols) in enumerate(options)]
            shape, cols = options[max(scored)[1]]
            self.shapes[family] = shape or {}
            self.columns |= {n: self.column(c) for n, c in cols.items()}
        self.names = [n for n, c in self.columns.items() if c is not None]
        self.matrix = np.stack([self.columns[n] for n in self.names], axis=1)
        self.scale = np.linalg.norm(self.matrix, axis=0)
        self.matrix = self.matrix / self.scale

    def nuisance(self):
        """Orthonormal basis of the declared parameters' columns and the constants with their stated uncertainty as prior rows."""
        cols = [self.white(c) for c in self.declared] + [self.white(c) * s for c, (_, s) in zip(self.constant_columns, self.constants)]
        a, extra = np.stack(cols, axis=1), len(self.constants)
        prior = np.zeros((extra, a.shape[1]))
        prior[:, a.shape[1] - extra :] = np.eye(extra)
        self.extra = extra
        a = np.concatenate([a, prior])
        self.basis = np.linalg.qr(a / np.linalg.norm(a, axis=0))[0]

    def project(self, v, prior=None):
        """What the declared parameters and constants leave of a whitened vector; `prior` is its part in the constants' rows."""
        v = np.concatenate([v, np.zeros(self.extra) if prior is None else prior])
        return v - self.basis @ (self.basis.T @ v)

    def column(self, parts):
        """Projected column; none when the declared model already spans it."""
        w = self.white(parts)
        p = self.project(w)
        return p if np.linalg.norm(p) > 1e-3 * max(np.linalg.norm(w), 1e-300) else None

    def gain(self, columns):
        """Fall of the residual's sum of squares by some columns."""
        a = [c for c in columns.values() if c is not None]
        if not a:
            return 0.0
        q = np.linalg.qr(np.stack(a, axis=1) / [np.linalg.norm(c) for c in a])[0]
        return float(((q.T @ self.target) ** 2).sum())

    def contact(self):
        """Where a pulse takes most from the residual: run, start and columns."""
        best, w = (-1.0, 0, 0.0), self.white
        for seg, y in zip(self.segs, self.before):
            n = len(seg.t)
            for start in np.arange(seg.t[0] + 1, seg.t[-1] - 1, CONTACT_SPACING_S):
                pulse = np.where((seg.t >= start) & (seg.t < start + PULSE_S), np.sin(np.pi * (seg.t - start) / PULSE_S) ** 2, 0.0)
                low = seg.lowpass(pulse.reshape(n, 1))[:, 0]
                near = np.flatnonzero(low > 1e-9)
                a, b = max(0, near[0] - 1), min(len(low), near[-1] + 2 + AR_ORDER)
                total = 0.0
                for c in range(6):
                    x = np.convolve(low[a:b], w.filters[c])[: b - a]
                    e = np.convolve(y[max(0, a - AR_ORDER) : b, c], w.filters[c])[min(a, AR_ORDER) : min(a, AR_ORDER) + b - a]
                    total += (x @ e) ** 2 / max(x @ x, 1e-300) / w.std[c] ** 2
                best = max(best, (total, seg.number, float(start)))
        shape = {"run": float(best[1]), "start_s": best[2], "duration_s": PULSE_S}
        return shape, family_columns(self.segs, self.veh, self.theta, self.base, "contact", shape)

    def family(self, name, value=1.0):
        """Family of a column; a delay by its sign."""
        family = name.split(".")[0]
        return OPPOSITE[family] if family in OPPOSITE and value < 0 else family

    def of(self, families):
        """Places of the columns of some families."""
        plain = {next((k for k, v in OPPOSITE.items() if v == f), f) for f in families}
        return [j for j, n in enumerate(self.names) if n.split(".")[0] in plain]

    def solve(self, places):
        """Coefficients, t-values and residual sum of squares for some columns."""
        a = self.matrix[:, places]
        if not places:
            return np.zeros(0), np.zeros(0), float(self.target @ self.target)
        b, *_ = np.linalg.lstsq(a, self.target, rcond=1e-9)
        rss = float(((self.target - a @ b) ** 2).sum())
        cov = np.linalg.pinv(a.T @ a) * rss / (len(self.target) - len(places))
        return b, b / np.sqrt(np.maximum(np.diag(cov), 1e-300)), rss

    def rivals(self, families):
        """For each family named and needed, those that explain about as much in its place."""
        if not families:
            return {}
        base, out = self.solve(self.of(families))[2], {}
        s2 = base / len(self.target)
        for f in families:
            others = [g for g in families if g != f]
            enough = lambda set_: self.solve(self.of(set_))[2] - base < 2 * RIVAL_NATS * s2
            trial = [g for g in FAMILIES if g not in families and self.of([g])]
            out[f] = [] if enough(others) else [g for g in trial if enough([*others, g])]
        return out

    def refit(self, families, iterations=2):
        """Parameters of a set on the runs to identify on, re-linearised; constants move within their stated uncertainty."""
        shapes = {knob(f, n): v for f in self.plain(families) for n, v in self.shapes[f].items()}
        names = [self.names[j] for j in self.of(families)]
        steps = {n: FAMILIES[n.split(".")[0]][n.split(".", 1)[1]] for n in names}
        sigma = {k: s for k, s in self.constants if k not in names}
        steps |= {k: STEPS.get(k, s) for k, s in sigma.items()}
        theta, values = self.theta.copy(), {n: self.base.get(n, 0.0) for n in steps}
        for _ in range(iterations):
            base = {**shapes, **values}
            y = [left(s, self.veh, theta, base) for s in self.segs]
            cols = self.theta_columns(theta, base, y) + [column(self.segs, self.veh, theta, base, n, h) for n, h in steps.items()]
            a = np.stack([self.white(c) for c in cols], axis=1)
            prior = np.stack([np.eye(a.shape[1])[11 + list(steps).index(k)] / s for k, s in sigma.items()]) if sigma else a[:0]
            meant = np.array([-values[k] / s for k, s in sigma.items()])
            a, target = np.concatenate([a, prior]), np.concatenate([self.white(y), meant])
            size = np.linalg.norm(a, axis=0)
            step = np.linalg.lstsq(a / size, target, rcond=1e-8)[0] / size
            theta = theta + theta_of(step[:11])
            values = {n: values[n] + d for n, d in zip(values, step[11:])}
        effects = {**shapes, **values}
        rest = [left(s, self.veh, theta, effects) for s in self.segs]
        return Fit(families, theta, effects, float((self.white(rest) ** 2).sum()), rest)

    def plain(self, families):
        return [next((k for k, v in OPPOSITE.items() if v == f), f) for f in families]

    def theta_columns(self, theta, base, y):
        return [[a - left(s, self.veh, theta + theta_of(u), base) for s, a in zip(self.segs, y)] for u in np.eye(11)]

    def residual_held(self):
        """Residual of the declared model on held-out runs."""
        return [left(s, self.veh, self.theta, self.base) for s in self.held]

    def held_out(self, theta, effects):
        """rms over held-out runs of specific force (m/s2) and angular acceleration (rad/s2), averaged over 0.4 s, and their noise."""
        return held_out([left(s, self.veh, theta, effects) for s in self.held])


def held_out(parts):
    """The same of residuals already there."""
    w = np.hanning(7)[1:-1]
    w = w / w.sum()
    smooth = np.concatenate([np.stack([np.convolve(c, w, "valid") for c in p.T], axis=1) for p in parts])
    square = (smooth**2).mean(axis=0)
    return float(np.sqrt(square[:3].sum())), float(np.sqrt(square[3:].sum()))
