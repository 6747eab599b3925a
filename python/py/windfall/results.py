"""Results by type, field by field as in the program's JSON files. Written by `just references` from the program; do not edit.

A number that is not finite is None, as it is null in the files.
"""

from __future__ import annotations

from typing import Any, Literal

from ._record import Record, Result

__all__ = [
    "After", "Band", "BandwidthLine", "Bootstrap", "BootstrapLine", "Bound", "CampaignOutcome", "CandidateLine",
    "CandidateReport", "ChannelResidual", "Check", "CheckLine", "Closing", "ClosingSummary", "CoefficientChoice",
    "CoefficientFit", "Compatibility", "ConfusionLine", "ConstantLine", "Correlation", "Count", "CriterionChoice", "Curve",
    "DataSet", "Deciding", "DependenceLine", "Descent", "DescentEnds", "DescentModel", "DescentReason", "DrawnParameter",
    "EffectBound", "EffectLine", "Envelope", "Estimate", "Estimated", "Explanation", "FailureKind", "FigureOver",
    "FigureSeparation", "Finding", "FittedInstead", "FlownCoefficient", "FlownParameter", "FlownValue", "Form", "FormCheck",
    "FoundEffect", "FoundNumber", "HeightLine", "Held", "HeldOut", "HeldOutTrajectory", "Identifiability", "Identification",
    "InnovationLine", "InnovationShape", "Instead", "InstrumentError", "Instruments", "LandingScatter", "Many", "NextRun",
    "NoiseLine", "NotNamed", "NumberLine", "OutcomeParameter", "ParameterLine", "ParameterShare", "ParameterSummary", "Plan",
    "PlanOption", "PooledParameter", "Pressure", "Quantile", "Rate", "Record", "RecoveredDraw", "RecoveryLine", "Refused",
    "ReliabilityPoint", "Residuals", "Resimulation", "Result", "RunComparison", "RunEnvelope", "RunValue", "Screened",
    "Separated", "Separation", "SetLine", "ShapeReport", "Sharpened", "Shift", "SimulatedHistory", "Statistic",
    "StatisticsClosing", "StatisticsOptions", "SteadyFall", "Structure", "Study", "Tally", "TargetPlan", "TermEstimate",
    "TouchDownLine", "TrajectoryError", "Unexplained", "VariedLine", "Verification", "WindTunnelLine", "WindTunnelModel",
    "WordLine",
]


class Correlation(Record):
    """Two parameters whose errors go together."""

    first: str
    second: str
    correlation: float


class Identifiability(Record):
    """What a campaign's runs can tell of its declared parameters."""

    free: int
    rank: int
    condition: float
    correlations: list[Correlation]
    inseparable: list[list[str]]
    expected: list[list[Any]]


class Pressure(Record):
    """Dynamic pressure against tunnel speed."""

    computed_from_speed: bool
    speed_scale: float
    speed_scale_ci95: list[float]
    pressure_scale: float
    pressure_scale_ci95: list[float]
    delay_s: float | None
    delay_ci95_s: list[float] | None
    p_value: float
    whiteness_p: float


class InstrumentError(Record):
    """One error."""

    name: str
    unit: str
    estimate: float
    std_error: float
    ci95: list[float]


class Instruments(Record):
    """Errors of the instruments by trajectories."""

    errors: list[InstrumentError]
    p_value: float
    account: list[InstrumentError]
    account_p_value: float
    rivals: list[InstrumentError]
    not_told: list[str]
    correlations: list[Correlation]
    residual: list[str]


class Compatibility(Record):
    """What was examined."""

    verdict: Literal["consistent", "inconsistent", "undecided"]
    false_alarm_rate: float
    pressure: Pressure | None
    instruments: Instruments | None
    not_examined: Literal["not-asked", "no-answer", "no-answer-with-errors"] | None


class Estimate(Record):
    """One parameter's estimate."""

    coefficient: str
    name: str
    estimate: float
    std_error: float
    rse_percent: float | None
    ci95: list[float]
    std_error_white: float


class CoefficientFit(Record):
    """How well one coefficient is explained."""

    coefficient: str
    r2: float
    residual_std: float
    residual_whiteness_p: float


class Envelope(Record):
    """What a run, or a set of runs, reached: the row of the thesis' Table 5.1, and the range in which what is identified on it is valid."""

    duration_s: float
    max_alpha_t_deg: float
    max_p_deg_s: float
    max_q_deg_s: float
    max_r_deg_s: float
    speed_m_s: list[float]
    reynolds_number: float | None


class Curve(Record):
    """One coefficient, or its damping, over an angle."""

    quantity: str
    over: str
    angle_deg: list[float]
    value: list[float]
    low: list[float]
    high: list[float]


class Held(Record):
    """A parameter held at a value."""

    name: str
    value: float


class FoundNumber(Record):
    """A number of the model beside its parameters."""

    name: str
    estimate: float
    std_error: float | None
    unit: str


class FoundEffect(Record):
    """An effect as the identified model has it."""

    family: str
    parameters: list[FoundNumber]


class Refused(Record):
    """A parameter without an estimate."""

    coefficient: str
    name: str
    reason: str


class DataSet(Record):
    """Parameters from one set of runs."""

    name: str
    runs: list[str]
    parameters: list[Estimate]
    fits: list[CoefficientFit]
    condition_number: float
    n_samples: int
    envelope: Envelope | None
    covariance: list[list[float]]
    curves: list[Curve]
    held: list[Held]
    constants: list[FoundNumber]
    effects: list[FoundEffect]
    refused: list[Refused]


class RunEnvelope(Record):
    """A run's row."""

    name: str
    kind: str
    used: str
    duration_s: float
    max_alpha_t_deg: float
    max_p_deg_s: float
    max_q_deg_s: float
    max_r_deg_s: float
    speed_m_s: list[float]
    reynolds_number: float | None


class BootstrapLine(Record):
    """One parameter over the copies."""

    coefficient: str
    name: str
    flown: float
    std_error: float
    scatter: float
    ratio: float
    bias_over_std_error: float
    covered: float


class Bootstrap(Record):
    """Scatter against stated errors."""

    draws: int
    failed: list[str]
    ratio_std_error: float
    parameters: list[BootstrapLine]


class WindTunnelModel(Record):
    """A model at the points of a wind-tunnel test."""

    model: str
    value: list[float]
    std: list[float]
    rms: float
    mean: float
    beyond_runs: int
    apart: int | None


class WindTunnelLine(Record):
    """One coefficient of one wind-tunnel test beside one or more models."""

    test: str
    quantity: str
    angle_deg: list[float]
    measured: list[float]
    std: list[float]
    models: list[WindTunnelModel]


class BandwidthLine(Record):
    """What was recognised of one run's channels."""

    run: str
    channels: Literal["position", "attitude", "tunnel-speed"]
    cause: Literal["smoothed", "interpolated", "repeated", "other-runs"]
    corner_hz: float | None
    original_hz: float | None
    bandwidth_hz: float
    thinned_from_hz: float
    thinned_to_hz: float


class Identification(Result):
    """The content of `identification.json`: an identification, and its check where one was asked for."""

    method: str
    reason: str | None
    smoothing: str | None
    identifiability: Identifiability | None
    compatibility: Compatibility | None
    data_sets: list[DataSet]
    envelopes: list[RunEnvelope]
    warnings: list[str]
    bootstrap: Bootstrap | None
    wind_tunnel: list[WindTunnelLine]
    bandwidth: list[BandwidthLine]


class FlownParameter(Record):
    """A parameter's value as flown."""

    name: str
    value: float
    identified: bool


class TrajectoryError(Record):
    """rms differences of simulation and measurement over a run."""

    attitude_rms_deg: float
    position_rms_m: float
    rate_rms_deg_s: float


class Statistic(Record):
    """One line of the thesis' Table 5.6."""

    quantity: str
    statistic: str
    test: float
    simulation: float
    simulation_std: float | None
    draws_ci95: list[float] | None


class Band(Record):
    """One quantity of one run over time."""

    quantity: str
    t_s: list[float]
    test: list[float]
    median: list[float]
    low: list[float]
    high: list[float]


class RunComparison(Record):
    """How one run compares."""

    name: str
    kind: str
    used: str
    trajectory: TrajectoryError
    trajectory_from_first_sample: TrajectoryError
    statistics: list[Statistic]
    misfit: float | None
    initial_span_s: float
    initial: Literal["converged", "nearly", "iterations", "no-descent", "flight-fails", "not-excited", "scale-away", "not-finite"] | dict[str, Any]
    duration_s: float
    flown_s: float
    specific_force_rms: list[float]
    specific_moment_rms: list[float]
    bands: list[Band]


class Resimulation(Result):
    """Result of a re-simulation."""

    method: str
    data_set: str
    parameters: list[FlownParameter]
    seeds: int
    trajectory: TrajectoryError
    statistics: list[Statistic]
    runs: list[RunComparison]
    warnings: list[str]


class Finding(Record):
    """A closing's conclusion for people: terminal, page, JSON and Python show this and nothing else."""

    level: Literal["good", "open", "contradicted"]
    sentence: str


class CheckLine(Record):
    """One absolute check: is what the model of `after` leaves noise?."""

    run: str
    used: Literal["identify", "hold-out"]
    what: str
    mean_square: float | None
    p_value: float
    ok: bool


class ChannelResidual(Record):
    """Residual of one channel against noise."""

    channel: str
    rms: float
    expected_rms: float
    p_value: float


class Residuals(Record):
    """Residuals of all channels."""

    per_channel: list[ChannelResidual]


class NoiseLine(Record):
    """Noise of a channel, learnt beside declared."""

    channel: str
    declared_std: float
    learnt_std: float
    colour: float
    coloured_share: float
    lines_hz: list[float]
    missing: int
    outliers: int


class InnovationShape(Record):
    """How innovations are distributed, and how each follows from those before it."""

    count: int
    ends: list[float]
    density: list[float]
    autocorrelation: list[float]


class InnovationLine(Record):
    """Histogram and autocorrelation of a channel's whitened innovations, over all identified runs."""

    channel: str
    step_s: float
    before: InnovationShape
    after: InnovationShape


class ConstantLine(Record):
    """A declared constant with an uncertainty, found beside declared."""

    key: str
    declared: float
    uncertainty: float
    estimate: float
    std_error: float | None
    unit: str


class SetLine(Record):
    """A set of effects with its probability."""

    families: list[str]
    probability: float


class NotNamed(Record):
    """A family of the likeliest set, or of the fit, that the verdict does not name."""

    family: str
    probability: float
    reason: str


class ParameterLine(Record):
    """One estimated number."""

    coefficient: str
    name: str
    estimate: float
    std_error: float | None
    ci95: list[float] | None
    rse_percent: float | None
    unit: str
    at_end: bool
    declared: float | None
    declared_std: float | None


class FlownValue(Record):
    """A coefficient at the settings of one run."""

    run: str
    estimate: float
    std_error: float


class FlownCoefficient(Record):
    """A coefficient that follows settings of the runs, at settings that were flown."""

    name: str
    in_all: bool
    least: FlownValue
    most: FlownValue


class RunValue(Record):
    """What a number that differs from run to run is in one run, less what it is in common."""

    run: str
    name: str
    unit: str
    value: float
    std_error: float


class FormCheck(Record):
    """One check of a form."""

    what: str
    p_value: float


class Form(Record):
    """Whether the form of a named effect holds against generic alternatives."""

    ok: bool
    checks: list[FormCheck]


class EffectLine(Record):
    """An effect that was added."""

    family: str
    parameters: list[ParameterLine]
    flown: list[FlownCoefficient]
    by_run: list[RunValue]
    p_value: float
    probability: float | None
    rivals: list[str]
    form: Form | None
    held_out_gain: float | None
    bursts: list[float] | None
    steep_edges: bool
    physics: str
    source: str
    separate_by: str


class CandidateLine(Record):
    """A family as weighed in the first round."""

    family: str
    score: float
    p_value: float


class EffectBound(Record):
    """How large a family that was not found could still be."""

    family: str
    parameter: str
    upper95: float
    unit: str


class Unexplained(Record):
    """A residual that no family accounts for."""

    channel: str
    description: str


class Shift(Record):
    """Declared parameter before and after."""

    name: str
    before: float
    after: float
    std_error_after: float


class Instead(Record):
    """A number that would do as well as a declared parameter that was moved."""

    key: str
    meaning: str
    declared: float
    estimate: float
    unit: str
    lost: float


class FittedInstead(Record):
    """A declared parameter that the runs moved, and other numbers that would do as well in its place."""

    parameter: str
    instead: list[Instead]


class HeldOutTrajectory(Record):
    """rms differences of simulation and measurement over runs that were not used."""

    attitude_rms_deg: float | None
    position_rms_m: float
    rate_rms_deg_s: float | None


class HeldOut(Record):
    """Errors on runs that were not used."""

    specific_force_rms: list[float] | None
    specific_moment_rms: list[float] | None
    trajectory: HeldOutTrajectory | None
    trajectory_of_noise: HeldOutTrajectory | None
    position_rms_m: float | None
    statistics: list[Statistic]
    log_likelihood: float | None


class After(Record):
    """One side of before and after."""

    parameters: list[ParameterLine]
    hold_out: HeldOut | None


class Closing(Result):
    """The closed loop: `close.json`."""

    campaign: str
    verdict: Literal["consistent", "effect", "unexplained"]
    finding: Finding
    checks: list[CheckLine]
    declared_departs: str | None
    noise_is_scatter: bool
    joined: list[str]
    record: list[str]
    bandwidth: list[BandwidthLine]
    unfinished_passes: float | None
    errors_carry_unexplained: bool
    residual: Residuals
    residual_after: Residuals
    noise: list[NoiseLine]
    innovations: list[InnovationLine]
    constants: list[ConstantLine]
    sets: list[SetLine]
    not_named: list[NotNamed]
    effects: list[EffectLine]
    candidates: list[CandidateLine]
    bounds: list[EffectBound]
    unexplained: list[Unexplained]
    shifts: list[Shift]
    instead: list[FittedInstead]
    before: After
    after: After
    wind_tunnel: list[WindTunnelLine]
    false_alarm_rate: float


class StatisticsOptions(Record):
    """How much is flown."""

    screen_points: int
    screen_runs: int
    pair_points: int
    pairs: int
    leads: int
    coarse_runs: int
    steps_per_parameter: int
    fine_runs: int
    kept: list[int]
    final_runs: int
    relative_tolerance: float


class FigureOver(Record):
    """One figure of a distribution over runs, beside the test."""

    quantity: Literal["theta_deg", "omega_qr_deg_s", "q_deg_s", "r_deg_s"]
    statistic: Literal["mean", "median", "std", "max"]
    fitted: bool
    test: float
    mean: float
    std: float
    central90: list[float]
    quantiles: list[float]
    relative: float
    inside: bool


class Screened(Record):
    """What screening said about one effect."""

    family: str
    largest_change: float
    gap_closed: float
    moves: bool
    leads: bool


class Estimated(Record):
    """A parameter of an explanation."""

    family: str
    name: str
    unit: str
    estimate: float
    ci95: list[float]
    decided: bool


class Explanation(Record):
    """Effects that may produce the figures, as well as they can."""

    families: list[str]
    parameters: list[Estimated]
    figures: list[FigureOver]
    j: float
    degrees: int
    p_value: float
    possible: bool
    closes: bool
    score: float
    left_section: float


class FigureSeparation(Record):
    """How well one run of these figures tells explanations apart."""

    truth: list[str]
    other: list[str]
    power: float


class SimulatedHistory(Record):
    """One simulated run over time, from its record as the figures are."""

    families: list[str]
    run: int
    t_s: list[float]
    theta_deg: list[float]
    omega_qr_deg_s: list[float]


class StatisticsClosing(Result):
    """The result."""

    verdict: str
    name: str
    source: str
    options: StatisticsOptions
    seed: int
    search_runs: list[int]
    final_runs: list[int]
    source_simulation: list[float | None]
    before: list[FigureOver]
    before_p_value: float
    screened: list[Screened]
    explanations: list[Explanation]
    separations: list[FigureSeparation]
    processing: list[float]
    histories: list[SimulatedHistory]
    flights: int
    conclusions: list[str]


class TermEstimate(Record):
    """Estimate of a chosen term, dimensionless."""

    name: str
    estimate: float
    std_error: float
    ci95: list[float]


class CandidateReport(Record):
    """What is said of a candidate."""

    name: str
    symmetry: Literal["revolution", "quarter-turn", "rotation", "none"]
    why: str
    partial_f: float
    fold_share: float | None
    chosen: bool


class ShapeReport(Record):
    """A term whose width was sought too."""

    name: str
    found: bool
    gain: float
    needed: float
    width_rad: float
    std_error_rad: float
    ci95_rad: list[float]


class CriterionChoice(Record):
    """Terms by one criterion."""

    criterion: Literal["white-f", "white-pse", "pse", "press", "bic", "cross-validation", "f", "subset", "agreed", "likelihood"]
    terms: list[str]
    value: float | None


class CoefficientChoice(Record):
    """One coefficient, or two that are one vector."""

    coefficient: str
    rows: int
    chosen: list[TermEstimate]
    candidates: list[CandidateReport]
    shape: ShapeReport | None
    criteria: list[CriterionChoice]


class Structure(Result):
    """What the runs of a campaign say about its structure."""

    criterion: Literal["white-f", "white-pse", "pse", "press", "bic", "cross-validation", "f", "subset", "agreed", "likelihood"]
    runs: list[str]
    coefficients: list[CoefficientChoice]
    warnings: list[str]


class PlanOption(Record):
    """Runs of one kind."""

    release_deg: float
    run_s: float
    runs: int
    minutes: float
    std_error: float


class TargetPlan(Record):
    """One parameter's way to its wanted error."""

    parameter: str
    estimate: float
    std_error_now: float
    std_error_wanted: float
    options: list[PlanOption]


class Plan(Result):
    """What the campaign has and what it takes."""

    method: str
    targets: list[TargetPlan]
    trim_m_s: float
    flown_deg: float
    between_s: float
    warnings: list[str]


class NextRun(Record):
    """A run that could be flown."""

    release_deg: float
    spin_deg_s: float
    offset_m: float
    speed_swing: float
    duration_s: float
    tunnel_time_s: float


class Deciding(Record):
    """A run with what it is expected to say between two rivals."""

    run: NextRun
    log_odds: list[float]
    simulated: list[float] | None


class Separated(Record):
    """Two sets that the campaign cannot tell apart."""

    families: list[str]
    rival: list[str]
    log_odds_now: float
    runs: list[Deciding]


class Sharpened(Record):
    """A bound with the run that sharpens it most for its tunnel time."""

    family: str
    parameter: str
    unit: str
    std_error_now: float
    std_error_then: float
    run: NextRun


class Separation(Result):
    """What to fly next."""

    campaign: str
    families: list[str]
    record: list[str]
    tried: int
    pairs: list[Separated]
    bounds: list[Sharpened]


class DescentModel(Record):
    """Where the coefficients are from."""

    method: str
    data_set: str


class DrawnParameter(Record):
    """A number that was drawn."""

    name: str
    nominal: float
    std: float


class DescentReason(Record):
    """Why descents failed."""

    reason: str
    count: int


class DescentEnds(Record):
    """How descents ended."""

    landed: int
    tumbled: int
    aloft: int
    failed: int
    reasons: list[DescentReason]


class ParameterShare(Record):
    """How much a quantity hangs on a parameter."""

    name: str
    share: float
    sign: int
    standardised: float
    std_if_known: float


class TouchDownLine(Record):
    """A quantity at touch-down over the descents that landed."""

    quantity: str
    nominal: float | None
    mean: float
    std: float
    low: float
    median: float
    high: float
    std_of_parameters: float
    std_of_flight: float
    share_of_parameters: float
    share_ci95: list[float]
    share_linear: float
    parameters: list[ParameterShare]


class LandingScatter(Record):
    """Places of touch-down from the start, in the horizontal plane of the start."""

    mean_m: list[float]
    half_axes95_m: list[float]
    heading_deg: float
    inside: float
    half_within_m: float
    places_m: list[list[float]]


class HeightLine(Record):
    """A quantity over height."""

    quantity: str
    height_m: list[float]
    draws: list[int]
    nominal: list[float | None]
    mean: list[float]
    std: list[float]
    low: list[float]
    median: list[float]
    high: list[float]


class SteadyFall(Record):
    """Linear theory at one height."""

    height_m: float
    density_kg_m3: float
    terminal_speed_m_s: float
    pitch_frequency_hz: float | None
    pitch_damping_per_s: float


class Descent(Result):
    """Many descents of an identified model."""

    scenario: str
    flight: str
    model: DescentModel | None
    draws: int
    seed: int
    step_s: float
    in_pairs: bool
    parameters: list[DrawnParameter]
    ends: DescentEnds
    touch_down: list[TouchDownLine]
    landing: LandingScatter | None
    over_height: list[HeightLine]
    linear_theory: list[SteadyFall]
    warnings: list[str]


class Tally(Record):
    """How many campaigns have something."""

    name: str
    count: int


class PooledParameter(Record):
    """One parameter over campaigns."""

    of: str
    name: str
    unit: str
    effect: bool
    n: int
    mean: float
    std_error: float
    ci95: list[float]
    tau: float
    tau_ci95: list[float]
    prediction95: list[float] | None
    q: float
    p_value: float


class OutcomeParameter(Record):
    """One estimated number of a campaign."""

    of: str
    name: str
    estimate: float
    std_error: float | None
    unit: str
    effect: bool


class CampaignOutcome(Record):
    """What one campaign gave: a row of `campaigns.parquet`."""

    path: str
    name: str
    status: Literal["ok", "failed"]
    exit_code: int
    reason: str
    method: str
    verdict: Literal["consistent", "effect", "unexplained"] | None
    families: list[str]
    probability: float | None
    worst_channel: str
    p_value: float | None
    parameters: list[OutcomeParameter]
    page: str | None


class Many(Result):
    """The content of `many.json`."""

    windfall: str
    each: Any
    campaigns: int
    ok: int
    failed: int
    verdicts: list[Tally]
    families: list[Tally]
    pooled: list[PooledParameter]
    table: str
    table_hash: str
    outcomes: list[CampaignOutcome]


class Rate(Record):
    """A rate with its 95 % interval (Clopper and Pearson 1934)."""

    name: str
    count: int
    of: int
    rate: float | None
    ci95: list[float] | None


class Count(Record):
    """A message and how often."""

    message: str
    count: int


class FailureKind(Record):
    """Draws that failed."""

    any: Rate
    messages: list[Count]


class ParameterSummary(Record):
    """How well one parameter is found."""

    method: str
    coefficient: str
    name: str
    n: int
    bias: float
    bias_ci95: list[float] | None
    scatter: float | None
    scatter_ci95: list[float] | None
    rms_error: float
    mean_std_error: float | None
    scatter_over_std_error: float | None
    coverage: Rate


class WordLine(Record):
    """How often a word stands in a column."""

    name: str
    counts: list[Rate]


class Quantile(Record):
    """A quantile of a column (linear between order statistics; Hyndman and Fan 1996, type 7)."""

    p: float
    value: float


class NumberLine(Record):
    """A column of numbers."""

    name: str
    n: int
    mean: float
    mean_ci95: list[float] | None
    std: float | None
    std_ci95: list[float] | None
    min: float
    max: float
    quantiles: list[Quantile]


class RecoveredDraw(Record):
    """One draw of a parameter."""

    truth: float
    estimate: float
    std_error: float
    row: int


class ReliabilityPoint(Record):
    """How often intervals hold the truth that are stated to do so with some probability."""

    stated: float
    count: int
    of: int
    ci95: list[float]


class RecoveryLine(Record):
    """A parameter's draws."""

    method: str
    coefficient: str
    name: str
    draws: list[RecoveredDraw]
    reliability: list[ReliabilityPoint]


class VariedLine(Record):
    """A varied quantity of the first draws."""

    name: str
    values: list[float]  # type: ignore[assignment]


class ConfusionLine(Record):
    """What was named in draws in which the same acts."""

    truth: str
    found: dict[str, int]


class DependenceLine(Record):
    """How right answers hang on one varied quantity."""

    name: str
    score: float | None
    values: list[float]  # type: ignore[assignment]
    shares: list[ReliabilityPoint]


class ClosingSummary(Record):
    """Closings of a study."""

    confusion: list[ConfusionLine]
    reliability: list[ReliabilityPoint]
    dependence: list[DependenceLine]


class Study(Result):
    """`summary.json`, without what belongs to the file."""

    study: str
    seed: int
    draws: int
    draws_ordered: int
    stopped_early: bool
    failures: FailureKind
    parameters: list[ParameterSummary]
    rates: list[Rate]
    words: list[WordLine]
    numbers: list[NumberLine]
    recovery: list[RecoveryLine]
    varied: list[VariedLine]
    closings: ClosingSummary | None


class Bound(Record):
    """Where a figure must be."""

    at_least: float | None
    at_most: float | None


class Check(Record):
    """One check."""

    id: str
    kind: Literal["exact", "published", "recovered"]
    what: str
    figure: float
    unit: str
    bound: Bound
    source: str
    thesis: float | None
    verdict: Literal["pass", "fail", "shown"]


class Verification(Result):
    """The content of `verify.json`."""

    verdict: str
    checks: list[Check]
