"""Peers that choose terms by regression: SINDy (sequentially thresholded least squares), stepwise regression, LASSO. Each is a rule
from a problem and a level to places of columns; the level is chosen on the peers' own flights (tune.py).
"""
import json
import pathlib
import time
import warnings

import numpy as np
import pysindy
from campaigns import Answer
from peers.random_loads import excess, random_load
from sklearn.linear_model import LassoCV, LassoLarsIC
from sklearn.model_selection import KFold

LEVELS = pathlib.Path(__file__).parent.parent / "levels.json"


def sindy(problem, level):
    """STLSQ over the catalogue's columns, all of unit length, so that the level is in standard deviations of a coefficient."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fit = pysindy.STLSQ(threshold=level, alpha=0.05, max_iter=30).fit(problem.matrix, problem.target[:, None])
    return [int(j) for j in np.flatnonzero(np.ravel(fit.coef_))]


def stepwise(problem, level):
    """Modified forward regression: in by the largest partial F above the level, out below it, until the predicted squared error rises
    (Klein and Morelli, Aircraft System Identification, 2006, section 5.4)."""
    chosen, n, y = [], len(problem.target), problem.target
    worst = float(y @ y) / n
    rss, best = float(y @ y), np.inf
    while len(chosen) < len(problem.names):
        trials = [(problem.solve(chosen + [j])[2], j) for j in range(len(problem.names)) if j not in chosen]
        new, j = min(trials)
        if (rss - new) / (new / (n - len(chosen) - 1)) < level:
            break
        trial = chosen + [j]
        while len(trial) > 1:
            t = problem.solve(trial)[1] ** 2
            if t.min() >= level:
                break
            trial.pop(int(t.argmin()))
        rss = problem.solve(trial)[2]
        pse = rss / n + 2 * worst * len(trial) / n
        if pse >= best or trial == chosen:
            break
        best, chosen = pse, trial
    return chosen


def pruned(problem, places, level):
    """Drops the weakest term until all have a t-value above the level."""
    places = list(places)
    while places:
        t = abs(problem.solve(places)[1])
        if t.min() >= level:
            break
        places.pop(int(t.argmin()))
    return places


def lasso_bic(problem, level):
    """LASSO at the penalty of the least BIC, then terms whose t-value is below the level go."""
    return pruned(problem, path(problem, "bic"), level)


def lasso_cv(problem, level):
    """LASSO at the penalty of five-fold cross-validation over stretches of time, then the same."""
    return pruned(problem, path(problem, "cv"), level)


def path(problem, rule):
    """Places that the penalty leaves; kept, since it does not depend on the level."""
    kept = problem.__dict__.setdefault("lasso", {})
    if rule not in kept:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            n = len(problem.target)
            if rule == "bic":
                model = LassoLarsIC(criterion="bic", fit_intercept=False)
            else:
                model = LassoCV(cv=KFold(5), fit_intercept=False, max_iter=20000)
            coefficients = model.fit(problem.matrix * np.sqrt(n), problem.target).coef_
        kept[rule] = [int(j) for j in np.flatnonzero(coefficients)]
    return kept[rule]


RULES = {"SINDy, catalogue": sindy, "stepwise": stepwise, "LASSO, BIC": lasso_bic, "LASSO, CV": lasso_cv}


def families(problem, places):
    """Families of columns, in order of their weight."""
    if not places:
        return []
    b = problem.solve(places)[0]
    order = np.argsort(-abs(b))
    return list(dict.fromkeys(problem.family(problem.names[places[j]], b[j]) for j in order))


def levels():
    return json.loads(LEVELS.read_text())


class Regression:
    def __init__(self, name, chosen=None):
        self.name, self.rule, self.levels = name, RULES[name], levels() if chosen is None else chosen

    def __call__(self, case, problem):
        start, known = time.process_time(), self.levels
        loud = excess(problem.rest, problem.noise).max() > known["excess"]
        random = random_load(problem, problem.rest) if loud else None
        named = families(problem, self.rule(problem, known[self.name]["gusty" if random else "calm"]))
        fit = problem.refit(named)
        beyond = excess(fit.residuals, problem.noise).max() > known["excess"]
        flagged = bool(beyond and not random)
        rivals = problem.rivals(named)
        seconds = time.process_time() - start + problem.seconds
        held = {"after": problem.held_out(fit.theta, fit.effects)}
        return Answer(named + ([random] if random else []), rivals, flagged, seconds, held)
