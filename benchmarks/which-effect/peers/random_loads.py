"""Is what the whole library leaves a random load of the catalogue? The same for all peers that regress.

Gusts: at every sample three air velocities account for the six residuals. Wake shedding: two moment coefficients do, in a band. A line
is neither.
"""
import numpy as np
from catalogue import column

SHARE = 0.7
LINE_SHARE = 0.6
LINE_HALF_WIDTH_HZ = 0.08


def excess(parts, noise):
    """Standard deviation of each channel over the one that white noise of the record's own size gives."""
    return np.sqrt(np.mean(np.concatenate(parts) ** 2, axis=0)) / noise


def line_share(parts, rate_hz):
    """Share of the power within a narrow band about the strongest frequency, summed over runs."""
    n = max(len(p) for p in parts)
    power = sum((abs(np.fft.rfft(p - p.mean(axis=0), 2 * n, axis=0)) ** 2).sum(axis=1) for p in parts)
    hz = np.fft.rfftfreq(2 * n, 1 / rate_hz)
    near = abs(hz - hz[np.argmax(power)]) < LINE_HALF_WIDTH_HZ
    return power[near].sum() / power.sum()


def random_load(problem, parts):
    """`turbulence`, `wake-shedding` or none, for residuals beyond noise."""
    r = np.concatenate(parts) / problem.noise
    beyond = (r**2).sum() - r.size
    if beyond <= 0:
        return None
    gust = [column(problem.segs, problem.veh, problem.theta, problem.base, f"gust.{a}", 0.05) for a in "xyz"]
    g = np.stack([np.concatenate(c) / problem.noise for c in gust], axis=2)
    w = np.linalg.solve(np.einsum("nij,nik->njk", g, g), np.einsum("nij,ni->nj", g, r)[:, :, None])
    by_gust = 1 - (((r - (g @ w)[:, :, 0]) ** 2).sum() - 3 * len(r)) / beyond
    by_moment = ((r[:, 4:] ** 2).sum() - 2 * len(r)) / beyond
    name, share = max((("turbulence", by_gust), ("wake-shedding", by_moment)), key=lambda x: x[1])
    step = problem.segs[0].dt * problem.segs[0].step
    loudest = int(np.argmax((r**2).sum(axis=0)))
    return name if share > SHARE and line_share([p[:, [loudest]] for p in parts], 1 / step) < LINE_SHARE else None
