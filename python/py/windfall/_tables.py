"""Of each kind of result the table that says most of it, what names its rows, and a line above it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import results as r

Rows = list[dict[str, Any]]


def _only(record: dict[str, Any], *without: str) -> dict[str, Any]:
    return {name: value for name, value in record.items() if name not in without}


def _identification(found: r.Identification) -> Rows:
    return [{"data_set": d.name, **_only(p)} for d in found.data_sets for p in d.parameters]


def _closing(closing: r.Closing) -> Rows:
    effects: Rows = [
        {"family": e.family, "probability": e.probability, "p_value": e.p_value, **_only(p, "coefficient")}
        for e in closing.effects
        for p in e.parameters
    ]
    declared: Rows = [
        {"family": "declared", "probability": None, "p_value": None, **_only(p, "coefficient")} for p in closing.after.parameters
    ]
    return effects + declared


def _resimulation(again: r.Resimulation) -> Rows:
    return [{"run": run.name, "kind": run.kind, "use": run.used, **run.trajectory, "misfit": run.misfit} for run in again.runs]


def _structure(chosen: r.Structure) -> Rows:
    return [{"coefficient": c.coefficient, **_only(t)} for c in chosen.coefficients for t in c.chosen]


def _plan(plan: r.Plan) -> Rows:
    nothing: Rows = [dict.fromkeys(("release_deg", "run_s", "runs", "minutes", "std_error"))]
    return [
        {"parameter": t.parameter, "std_error_now": t.std_error_now, "std_error_wanted": t.std_error_wanted, **option}
        for t in plan.targets
        for option in ([_only(o) for o in t.options] or nothing)
    ]


def _separation(plan: r.Separation) -> Rows:
    return [
        {
            "families": ", ".join(p.families),
            "rival": ", ".join(p.rival),
            "log_odds_now": p.log_odds_now,
            "choice": i,
            **d.run,
            "log_odds": d.log_odds,
        }
        for p in plan.pairs
        for i, d in enumerate(p.runs)
    ]


def _descent(descent: r.Descent) -> Rows:
    return [_only(line, "parameters") for line in descent.touch_down]


def _many(many: r.Many) -> Rows:
    return [{**_only(o, "parameters", "families"), "families": ", ".join(o.families)} for o in many.outcomes]


def _study(study: r.Study) -> Rows:
    return [{**_only(p, "coverage"), "coverage": p.coverage.rate} for p in study.parameters]


def _verification(verified: r.Verification) -> Rows:
    return [{**_only(c, "bound"), "at_least": c.bound.at_least, "at_most": c.bound.at_most} for c in verified.checks]


def _statistics(closing: r.StatisticsClosing) -> Rows:
    return [
        {"families": ", ".join(e.families), "p_value": e.p_value, "closes": e.closes, "score": e.score, "possible": e.possible}
        for e in closing.explanations
    ]


#: Rows of each kind of result.
TABLES: dict[str, Callable[[Any], Rows]] = {
    "Identification": _identification,
    "Closing": _closing,
    "Resimulation": _resimulation,
    "Structure": _structure,
    "Plan": _plan,
    "Separation": _separation,
    "Descent": _descent,
    "Many": _many,
    "Study": _study,
    "Verification": _verification,
    "StatisticsClosing": _statistics,
}

#: What names a row.
KEYS = {
    "Identification": ["data_set", "name"],
    "Closing": ["family", "name"],
    "Resimulation": ["run"],
    "Structure": ["coefficient", "name"],
    "Plan": ["parameter", "release_deg"],
    "Separation": ["families", "rival", "choice"],
    "Descent": ["quantity"],
    "Many": ["path"],
    "Study": ["method", "coefficient", "name"],
    "Verification": ["id"],
    "StatisticsClosing": ["families"],
}


def title(result: Any) -> str:
    """One line of a result in words."""
    kind = type(result).__name__
    if kind == "Closing":
        # Files of earlier versions have no finding.
        return f"{result.campaign}: {result.finding.sentence if result.finding else result.verdict}"
    if kind == "Many":
        return f"{result.campaigns} campaigns: {result.ok} with a result, {result.failed} failed"
    if kind == "Study":
        return f"{result.study}: {result.draws} draws"
    if kind == "Descent":
        return f"{result.scenario}: {result.draws} descents, {result.ends.landed} landed"
    words = [result.get(key) for key in ("verdict", "method", "criterion", "campaign")]
    return ": ".join([kind, *(w for w in words if w)])
