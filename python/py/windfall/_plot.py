"""A figure of each kind of result, by matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import BytesIO
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from . import results as r


_NORMAL_95 = NormalDist().inv_cdf(0.975)
"""Standard errors to either side that a 95 % interval reaches."""


class Drawn(Figure):
    """A figure that notebooks show where a cell returns it, whatever backend is chosen."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png")
        return png.getvalue()


def figure(result: Any) -> Figure:
    """A figure of a result, drawn but not shown: notebooks show what a cell returns, `savefig` writes it."""
    return _FIGURES[type(result).__name__](result)


def _axes(count: int, across: int = 2) -> tuple[Figure, Sequence[Axes]]:
    down = -(-count // across) or 1
    drawn = Drawn(figsize=(4.2 * min(count, across), 2.8 * down), layout="constrained")
    return drawn, [drawn.add_subplot(down, min(count, across), i + 1) for i in range(count)]


def _bars(axes: Axes, names: Sequence[str], values: Sequence[float], errors: Sequence[float] | None, label: str) -> None:
    axes.errorbar(values, range(len(names)), xerr=errors, fmt="o", capsize=2)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel(label)


def _identification(found: r.Identification) -> Figure:
    """Coefficients with their bands of 95 %; without curves the parameters' relative errors."""
    sets = [d for d in found.data_sets if d.curves]
    if not sets:
        drawn, (axes,) = _axes(1)
        parameters = found.data_sets[-1].parameters
        _bars(
            axes,
            [p.name for p in parameters],
            [p.rse_percent or 0.0 for p in parameters],
            None,
            "standard error, % of the estimate",
        )
        return drawn
    quantities = list(dict.fromkeys(c.quantity for d in sets for c in d.curves))
    drawn, all_axes = _axes(len(quantities))
    for quantity, axes in zip(quantities, all_axes, strict=True):
        for d in sets:
            for c in (c for c in d.curves if c.quantity == quantity):
                (line,) = axes.plot(c.angle_deg, c.value, label=d.name)
                axes.fill_between(c.angle_deg, c.low, c.high, alpha=0.3, color=line.get_color(), linewidth=0)
                axes.set_xlabel(f"{c.over}, deg")
        axes.set_ylabel(quantity)
    all_axes[0].legend()
    return drawn


def _closing(closing: r.Closing) -> Figure:
    """Residual over what noise makes, channel by channel; probabilities of the sets of effects."""
    drawn, (left, right) = _axes(2)
    for word, lines, mark in (("declared", closing.residual, "o"), ("with effects", closing.residual_after, "x")):
        channels = [c for c in lines.per_channel if c.expected_rms]
        left.plot([c.rms / c.expected_rms for c in channels], range(len(channels)), mark, label=word)
        left.set_yticks(range(len(channels)), [c.channel for c in channels])
    left.axvline(1.0, linewidth=0.8, color="grey")
    left.set_xscale("log")
    left.set_xlabel("residual / noise")
    left.legend()
    sets = closing.sets[:6]
    right.barh([", ".join(s.families) or "nothing lacks" for s in sets], [s.probability for s in sets])
    right.invert_yaxis()
    right.set_xlabel("probability")
    drawn.suptitle(f"{closing.campaign}: {closing.verdict}")
    return drawn


def _resimulation(again: r.Resimulation) -> Figure:
    """Bands where there are any, else each run's error in attitude."""
    bands = [(run.name, b) for run in again.runs for b in run.bands]
    if not bands:
        drawn, (axes,) = _axes(1)
        _bars(
            axes,
            [run.name for run in again.runs],
            [run.trajectory.attitude_rms_deg for run in again.runs],
            None,
            "attitude error, deg rms",
        )
        return drawn
    drawn, all_axes = _axes(len(bands))
    for (run, b), axes in zip(bands, all_axes, strict=True):
        axes.fill_between(b.t_s, b.low, b.high, alpha=0.4, label="model, 95 %")
        axes.plot(b.t_s, b.test, linewidth=0.8, color="black", label="test")
        axes.set(xlabel="t, s", ylabel=b.quantity, title=run)
    all_axes[0].legend()
    return drawn


def _structure(chosen: r.Structure) -> Figure:
    drawn, (axes,) = _axes(1)
    terms = [t for c in chosen.coefficients for t in c.chosen]
    _bars(axes, [t.name for t in terms], [abs(t.estimate) / t.std_error for t in terms], None, "|estimate| / standard error")
    axes.set_xscale("log")
    return drawn


def _plan(plan: r.Plan) -> Figure:
    drawn, (axes,) = _axes(1)
    for t in plan.targets:
        axes.plot([o.minutes for o in t.options], [o.std_error / t.std_error_wanted for o in t.options], "o", label=t.parameter)
    axes.axhline(1.0, linewidth=0.8, color="grey")
    axes.set(xlabel="tunnel time, min", ylabel="standard error / wanted")
    axes.legend()
    return drawn


def _separation(plan: r.Separation) -> Figure:
    drawn, (axes,) = _axes(1)
    for p in plan.pairs:
        axes.plot(
            [d.run.tunnel_time_s for d in p.runs],
            [d.log_odds[0] for d in p.runs],
            "o",
            label=" or ".join(map(", ".join, (p.families, p.rival))),
        )
    axes.set(xlabel="tunnel time, s", ylabel="log odds expected")
    if plan.pairs:
        axes.legend()
    return drawn


def _descent(descent: r.Descent) -> Figure:
    """Every quantity over height, with the band of 95 %."""
    drawn, all_axes = _axes(len(descent.over_height))
    for line, axes in zip(descent.over_height, all_axes, strict=True):
        axes.fill_betweenx(line.height_m, line.low, line.high, alpha=0.4)
        axes.plot(line.median, line.height_m)
        axes.set(xlabel=line.quantity, ylabel="height, m")
    return drawn


def _many(many: r.Many) -> Figure:
    """Every pooled parameter over its campaigns, as departures from the mean."""
    drawn, all_axes = _axes(max(len(many.pooled), 1), across=3)
    for p, axes in zip(many.pooled, all_axes, strict=False):
        of = [
            (o.name, q)
            for o in many.outcomes
            for q in o.parameters
            if (q.of, q.name, q.unit) == (p.of, p.name, p.unit) and q.std_error
        ]
        _bars(
            axes,
            [name for name, _ in of],
            [q.estimate for _, q in of],
            [_NORMAL_95 * (q.std_error or 0.0) for _, q in of],
            f"{p.name}, {p.unit}",
        )
        axes.axvspan(p.ci95[0], p.ci95[1], alpha=0.3)
    return drawn


def _study(study: r.Study) -> Figure:
    """Scatter over what is stated, and how often intervals of 95 % hold the truth."""
    drawn, (left, right) = _axes(2)
    names = [f"{p.name} ({p.method})" for p in study.parameters]
    nan = float("nan")
    _bars(left, names, [p.scatter_over_std_error or nan for p in study.parameters], None, "scatter / stated error")
    covered = [nan if p.coverage.rate is None else 100 * p.coverage.rate for p in study.parameters]
    _bars(right, names, covered, None, "intervals that hold, %")
    left.axvline(1.0, linewidth=0.8, color="grey")
    right.axvline(95.0, linewidth=0.8, color="grey")
    return drawn


def _verification(verified: r.Verification) -> Figure:
    """Every figure that has an upper bound, over it."""
    drawn = Drawn(figsize=(7.0, 0.16 * len(verified.checks) + 1.0), layout="constrained")
    axes = drawn.add_subplot()
    bounded = [c for c in verified.checks if c.bound.at_most and c.figure > 0.0]
    _bars(axes, [c.id for c in bounded], [c.figure / (c.bound.at_most or 1.0) for c in bounded], None, "figure / bound")
    axes.set_xscale("log")
    axes.axvline(1.0, linewidth=0.8, color="grey")
    axes.tick_params(axis="y", labelsize=6)
    return drawn


def _statistics(closing: r.StatisticsClosing) -> Figure:
    drawn, (axes,) = _axes(1)
    best = closing.explanations[:10]
    _bars(axes, [", ".join(e.families) or "declared" for e in best], [e.score for e in best], None, "score")
    return drawn


def _flight(flight: Any) -> Figure:
    """Position and attitude of the record over time."""
    drawn, all_axes = _axes(2)
    record = flight["record"]
    for axes, names in zip(all_axes, (("X_m", "Y_m", "Z_m"), ("Rx_deg", "Ry_deg", "Rz_deg")), strict=True):
        for name in names:
            axes.plot(record["t_s"], record[name], label=name, linewidth=0.8)
        axes.set_xlabel("t, s")
        axes.legend()
    drawn.suptitle(f"{flight['name']}: {flight['end']}")
    return drawn


_FIGURES: dict[str, Callable[[Any], Figure]] = {
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
    "Flight": _flight,
}
