"""Offline, under a minute: the reader on flights with a known answer, a peer on them, and the scoring rule."""
import numpy as np
import pytest
import simulate
from campaigns import Answer, Case, cases, outcome
from lander import expected_noise, residual
from peers.regression import Regression
from problem import Problem
from reader import kernels, read

LEVELS = {"stepwise": {"calm": 30.0, "gusty": 300.0}, "excess": 1.5}


def make(folder, name, family, knobs):
    rng = np.random.default_rng(3)
    veh, theta = simulate.draw_vehicle(rng, 0.0)
    records = simulate.noisy(simulate.fly(veh, theta, knobs, rng, seconds=9.0), rng)
    row = simulate.write(folder, name, veh, records, family)
    simulate.answers(folder, [row])
    return theta


def test_smooth_kernel_is_the_second_integral_of_the_second_derivative():
    (value, first, second), h = kernels(0.01)
    assert len(h) == len(second) - 2
    assert h.sum() == pytest.approx(1.0, abs=1e-9)
    t = (np.arange(len(second)) - len(second) // 2) * 0.01
    assert second[::-1] @ (0.5 * 9.8 * t**2) == pytest.approx(9.8, abs=1e-9)
    assert first[::-1] @ (2.0 * t) == pytest.approx(2.0, abs=1e-9)
    assert value.sum() == pytest.approx(1.0, abs=1e-9)


def test_residual_of_the_true_model_is_noise(tmp_path):
    theta = make(tmp_path, "clean", "none", {})
    veh, segments = read(tmp_path / "clean" / "campaign.toml")
    parts = [residual(s, veh, theta) / expected_noise(s) for s in segments]
    assert np.sqrt(np.mean(np.concatenate(parts) ** 2, axis=0)) == pytest.approx(1.0, abs=0.12)


def test_a_sign_wrong_in_the_model_shows(tmp_path):
    theta = make(tmp_path, "clean", "none", {})
    veh, segments = read(tmp_path / "clean" / "campaign.toml")
    theta[5] = -theta[5]
    parts = [residual(s, veh, theta) / expected_noise(s) for s in segments]
    assert np.sqrt(np.mean(np.concatenate(parts)[:, 4] ** 2)) > 3


@pytest.mark.parametrize(("family", "knobs"), [("none", {}), ("asymmetry", {"asymmetry.Cm_0": 0.05, "asymmetry.Cn_0": -0.03}), ("swirl", {"swirl.rad_per_m": 0.04})])
def test_stepwise_finds_what_was_put_in(tmp_path, family, knobs):
    make(tmp_path, family, family, knobs)
    case = cases(tmp_path)[0]
    problem = Problem(case.path)
    answer = Regression("stepwise", LEVELS)(case, problem)
    assert outcome(case, answer) == "right"
    fit = problem.refit([])
    before, after = problem.held_out(fit.theta, fit.effects), answer.held_out["after"]
    assert after == pytest.approx(before) if family == "none" else after[1] < 0.7 * before[1]


def test_rule():
    said = lambda *named, flagged=False, **rivals: Answer(list(named), {k.replace("_", "-"): v for k, v in rivals.items()}, flagged, 0.0)
    of = lambda *wanted, group="B", rivals=(): Case("x", None, group, "x", list(wanted), list(rivals))
    assert outcome(of("none"), said()) == "right"
    assert outcome(of("none"), said("magnus")) == "wrong"
    assert outcome(of("none"), said(flagged=True)) == "refused"
    assert outcome(of("magnus"), said()) == "missed"
    assert outcome(of("magnus"), said(flagged=True)) == "refused"
    assert outcome(of("magnus"), said("inertia", inertia=["magnus"])) == "right"
    assert outcome(of("magnus"), said("magnus", "swirl")) == "wrong"
    assert outcome(of("magnus", "swirl"), said("swirl")) == "missed"
    assert outcome(of("center-of-mass", rivals=["asymmetry"]), said("asymmetry")) == "right"
    assert outcome(of("unexplained"), said("swirl", flagged=True)) == "right"
    assert outcome(of("unexplained"), said("swirl")) == "wrong"
    assert outcome(of("unexplained"), said()) == "missed"
    assert outcome(of("magnus", group="G"), said()) == "right"
    clock = Case("x", None, "E", "x", ["unexplained"], [], "time-base")
    assert outcome(clock, said("time-base")) == "right"
    assert outcome(clock, said("length-scale", length_scale=["time-base"])) == "right"
    assert outcome(clock, said("time-base", "swirl")) == "wrong"
