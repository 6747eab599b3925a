"""Peers without the catalogue's terms: SINDy with a polynomial library, whose find is then held against the families, and Gaussian
processes, which name nothing.
"""
import time
import warnings

import numpy as np
import pysindy
from campaigns import Answer
from lander import back, euler_to_rates, turn
from peers.random_loads import excess, random_load
from peers.regression import levels
from reader import rotation
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from problem import held_out

ALIKE = 0.8
MOST_FAMILIES = 3
GP_POINTS = 350


def states(seg, veh):
    """Eight states of a segment: flow angles y and z, three rates over V/d, speed, place across the tunnel."""
    r, w = rotation(seg.e[0]), turn(euler_to_rates(seg.e[0])[0], seg.e[1])
    u = back(r, seg.x[1] + np.stack([seg.vw[0], 0 * seg.vw[0], 0 * seg.vw[0]], axis=1))
    speed = np.linalg.norm(u, axis=1)
    hat = veh.diameter / (2 * speed)
    return np.stack([u[:, 1] / speed, u[:, 2] / speed, *(w * hat[:, None]).T, speed / 7.5 - 1, seg.x[0][:, 1], seg.x[0][:, 2]], axis=1)


class Polynomial:
    """SINDy over all products of two states in each channel. A find is named by the families whose columns span it, if they do."""

    name = "SINDy, polynomials"

    def __init__(self, chosen=None):
        self.levels = levels() if chosen is None else chosen

    def library(self, problem):
        """Scaled columns of each segment, seen through the smooth kernel."""
        if "polynomials" not in problem.__dict__:
            both = [states(s, problem.veh) for s in problem.segs], [states(s, problem.veh) for s in problem.held]
            size = np.sqrt(np.mean(np.concatenate(both[0]) ** 2, axis=0))
            lib = pysindy.PolynomialLibrary(degree=2).fit(both[0][0])
            make = lambda segs, xs: [s.lowpass(np.asarray(lib.transform(x / size))) for s, x in zip(segs, xs)]
            problem.polynomials = make(problem.segs, both[0]), make(problem.held, both[1])
        return problem.polynomials

    def coefficients(self, problem, level):
        """One column of coefficients for each channel."""
        parts, w, out = self.library(problem)[0], problem.white, []
        for c in range(6):
            x = np.concatenate([np.stack([np.convolve(f, w.filters[c], "valid") for f in p.T], axis=1) for p in parts]) / w.std[c]
            y = np.concatenate([np.convolve(p[:, c], w.filters[c], "valid") for p in problem.before]) / w.std[c]
            size = np.maximum(np.linalg.norm(x, axis=0), 1e-12)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                fit = pysindy.STLSQ(threshold=level, alpha=0.05, max_iter=30).fit(x / size, y[:, None])
            out.append(np.ravel(fit.coef_) / size)
        return np.stack(out, axis=1)

    def chosen(self, problem, level):
        return np.flatnonzero(self.coefficients(problem, level).any(axis=1))

    def __call__(self, case, problem):
        start = time.process_time()
        loud = excess(problem.rest, problem.noise).max() > self.levels["excess"]
        random = random_load(problem, problem.rest) if loud else None
        b = self.coefficients(problem, self.levels[self.name]["gusty" if random else "calm"])
        own, held = self.library(problem)
        find = problem.project(problem.white([p @ b for p in own]))
        named, spanned = self.match(problem, find) if b.any() else ([], True)
        left = [y - p @ b for y, p in zip(problem.before, own)]
        beyond = excess(left, problem.noise).max() > self.levels["excess"] and not random
        error = held_out([y - p @ b for y, p in zip(problem.residual_held(), held)])
        seconds = time.process_time() - start + problem.seconds
        named = named + ([random] if random else [])
        return Answer(named, {}, bool(beyond or not spanned), seconds, {"after": error})

    def match(self, problem, find):
        """Families that together span the find, fewest first; nothing where three do not."""
        named, whole = [], float(find @ find)
        while len(named) < MOST_FAMILIES:
            trial = sorted({n.split(".")[0] for n in problem.names} - set(named))
            share = []
            for f in trial:
                q = np.linalg.qr(problem.matrix[:, problem.of(named + [f])])[0]
                share.append((float(((q.T @ find) ** 2).sum()) / whole, f))
            best, family = max(share)
            named.append(family)
            if best > ALIKE:
                return named, True
        return [], False


class GaussianProcess:
    """A Gaussian process of the eight states for each channel (squared exponential, a length for each state, white noise)."""

    name = "Gaussian process"
    needs_library = False

    def __init__(self, chosen=None):
        self.levels = levels() if chosen is None else chosen

    def data(self, problem, segs, residuals):
        w = np.hanning(7)[1:-1]
        w = w / w.sum()
        smooth = lambda a: np.stack([np.convolve(c, w, "valid") for c in a.T], axis=1)
        return [(smooth(s.thin(states(s, problem.veh))), smooth(y)) for s, y in zip(segs, residuals)]

    def fit(self, own, problem):
        """Models of all channels and the fall of the rms when each run is predicted by the others."""
        x, y = (np.concatenate([d[k] for d in own]) for k in (0, 1))
        run = np.concatenate([[k] * len(d[0]) for k, d in enumerate(own)])
        size, some = x.std(axis=0), np.linspace(0, len(x) - 1, min(GP_POINTS, len(x))).astype(int)
        models, square = [], np.zeros((6, 2))
        for c in range(6):
            kernel = ConstantKernel(1.0, (1e-4, 1e3)) * RBF(np.ones(8), (0.1, 1e3)) + WhiteKernel(1.0, (1e-2, 1e2))
            scale = y[:, c].std()
            model = GaussianProcessRegressor(kernel, random_state=0).fit(x[some] / size, y[some, c] / scale)
            for k in set(run):
                here, rest = run == k, some[run[some] != k]
                if len(rest) < 20:
                    continue
                fixed = GaussianProcessRegressor(model.kernel_, optimizer=None).fit(x[rest] / size, y[rest, c] / scale)
                left = y[here, c] - scale * fixed.predict(x[here] / size)
                square[c] += [(y[here, c] ** 2).sum(), (left**2).sum()]
            models.append((model, size, scale))
        return models, float(np.sqrt((square[:, 1] / np.maximum(square[:, 0], 1e-300)).min()))

    def ratio(self, problem):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return self.fit(self.data(problem, problem.segs, problem.before), problem)

    def __call__(self, case, problem):
        start = time.process_time()
        models, ratio = self.ratio(problem)
        flagged = ratio < self.levels[self.name] or excess(problem.before, problem.noise).max() > self.levels["excess"]
        square = []
        for x, y in self.data(problem, problem.held, problem.residual_held()):
            left = np.stack([y[:, c] - s * m.predict(x / z) for c, (m, z, s) in enumerate(models)], axis=1)
            square.append(left if ratio < self.levels[self.name] else y)
        mean = (np.concatenate(square) ** 2).mean(axis=0)
        seconds = time.process_time() - start + problem.seconds
        held = float(np.sqrt(mean[:3].sum())), float(np.sqrt(mean[3:].sum()))
        return Answer([], {}, bool(flagged), seconds, {"after": held})
