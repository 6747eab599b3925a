"""What each verb takes by keyword. Written by `just references` from windfall/src/requests.rs; do not edit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypedDict

__all__ = ["CHOICES", "ENTRIES", "Close", "Descend", "Fly", "Identify", "Init", "Many", "Plan", "Resimulate", "Structure", "Study"]


class Fly(TypedDict, total=False):
    """
    seed: Seed of all chance, in place of the scenario's
    """

    seed: int | None


class Identify(TypedDict, total=False):
    """
    accept_record: Go on although the check of the record refuses it; the result says so
    bootstrap: Check the stated errors by N copies: the identified model is flown again with the campaign's own inputs and
        noise, and identified again; scatter over stated error is known to 1/√(2N)
    combined: Only all runs together, without each kind of run alone
    cutoffs: Cut-off frequency of the thesis' smoothing, Hz: one for all channels (3), or by channel (X=1.5,Rx=2.5), where a
        channel that is not named has that of its Table 3.1; method thesis [default: Table 3.1]
    hold: Hold a parameter: it is not estimated but kept at this value (Cl_0=0.0125); may be repeated
    method: How to identify [default: output-error where its residual is noise, filter-error where process noise is found; the
        result says which and why]; one of thesis, equation-error, output-error, filter-error
    prior: What is known of a parameter beforehand: mean and standard deviation (Cl_p=-5.7±0.3 or Cl_p=-5.7:0.3); methods that
        integrate; may be repeated
    tie: Tie a parameter to another: both are one unknown (Cn_1=Cm_1: pitch and yaw damping shared); methods that integrate;
        may be repeated
    unsmoothed: No smoothing, as in the thesis' Appendix C: values as recorded, derivatives by quadratics through five
        samples; method thesis
    """

    accept_record: bool | None
    bootstrap: int | None
    combined: bool | None
    cutoffs: Mapping[str, float] | None
    hold: Mapping[str, float] | None
    method: str | None
    prior: Mapping[str, tuple[float, float]] | None
    tie: Mapping[str, str] | None
    unsmoothed: bool | None


class Structure(TypedDict, total=False):
    """
    criterion: By which terms are chosen: likelihood (trajectories and gusts), subset or f or agreed (regression, residuals of
        any colour), bic, pse, press, cross-validation; white-f and white-pse take residuals as white [default: likelihood]
    """

    criterion: str | None


class Plan(TypedDict, total=False):
    """
    accept_record: With --separate: go on although the check of the record refuses it; the result says so
    between: Time between runs that counts as tunnel time, s [default: 60.0]
    separate: Instead: the runs that part the effects these runs cannot tell apart, and sharpen bounds that are wide, for
        their tunnel time
    """

    accept_record: bool | None
    between: float | None
    separate: bool | None


class Resimulate(TypedDict, total=False):
    """
    draws: Also fly N models with parameters drawn from their covariance: 95 % bands on Θ and ω_q,r, intervals of the
        statistics; 40 to 200 are enough, 0 is none [default: 0]
    seeds: Number of seeds over which simulated statistics are averaged [default: 1]
    """

    draws: int | None
    seeds: int | None


class Descend(TypedDict, total=False):
    """
    draws: Number of descents, each with a model drawn from the identification's posterior; where gusts or the start differ as
        well, each model flies twice [default: 1000]
    flight: Which flight of the scenario [default: the first]
    seed: Seed of all chance, in place of the scenario's
    """

    draws: int | None
    flight: str | None
    seed: int | None


class Close(TypedDict, total=False):
    """
    accept_record: Go on although the check of the record refuses it; the result says so
    """

    accept_record: bool | None


class Study(TypedDict, total=False):
    """
    force: Overwrite results that exist
    resume: Go on with the draws that another run of this study left in the folder
    shard: Draw share i of n only, i from 1 to n; when all shares are there, --resume without --shard joins them
    """

    force: bool | None
    resume: bool | None
    shard: Sequence[int] | None


class Init(TypedDict, total=False):
    """
    kind: Kind of campaign [default: guessed from the columns]; one of tunnel, free-flight, point, pivot
    """

    kind: str | None


class Many(TypedDict, total=False):
    """
    force: Overwrite results that exist
    resume: Go on with what another run left in the folder: campaigns that are done and whose files say the same are not done
        again
    shard: Do share i of n only, i from 1 to n: every n-th campaign; when all shares are there, --resume without --shard joins
        them
    """

    force: bool | None
    resume: bool | None
    shard: Sequence[int] | None


#: Words that a keyword may be.
CHOICES = {
    "kind": ("tunnel", "free-flight", "point", "pivot"),
    "method": ("thesis", "equation-error", "output-error", "filter-error"),
}

#: Names of what a mapping of the first to the rest holds.
ENTRIES = {
    "cutoffs": ("channel", "hz"),
    "hold": ("name", "value"),
    "prior": ("name", "mean", "std"),
    "tie": ("name", "to"),
}
