"""Every public function once, against what is known of it; errors as exceptions with their faults."""

import doctest
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import windfall
from windfall import _windfall

# Thesis Table 5.5.
TABLE_5_5 = {"CA_T0": 6.6620, "CN_sin": 3.5129, "Cm_sin": -2.0655, "Cm_2": -205.4289, "Cl_p": -5.6816}


def study_file(folder: Path, draws: int = 40, part: int = 8, more: str = "") -> Path:
    """A study of a 2 s flight, in files of its own."""
    scenario = (Path(__file__).parents[2] / "scenarios/bundled/sage-perturbed.toml").read_text()
    short = scenario.replace("duration_s = 18.3", "duration_s = 2.0").replace("rate_hz = 150.0", "rate_hz = 100.0")
    (folder / "short.toml").write_text(short)
    head = f'[study]\nname = "test"\nscenario = "short.toml"\ndraws = {draws}\nseed = 3\npart_draws = {part}\n'
    path = folder / "study.toml"
    path.write_text(head + '[do]\nidentify = ["equation-error"]\n' + more)
    return path


def files(folder: Path) -> list[bytes]:
    return [(folder / name).read_bytes() for name in ("runs.parquet", "summary.json")]


def test_law_flights_are_arrays_that_own_one_time_grid():
    (flight,) = windfall.simulate("appendix-c")
    record, truth = flight["record"], flight["truth"]
    assert flight["end"] == "completed" and len(record["t_s"]) == 2251
    assert all(x.dtype == np.float64 and x.shape == (2251,) for x in record.values())
    assert truth["quaternion"].shape == (2251, 4) and truth["p_tunnel_cm_m"].shape == (2251, 3)
    # Unit quaternions to rounding; recorded and true attitude agree without sensor noise.
    assert np.abs(np.linalg.norm(truth["quaternion"], axis=1) - 1).max() < 1e-15
    assert np.abs(np.degrees(truth["attitude_rad"][:, 1]) - record["Ry_deg"]).max() < 1e-12
    record["t_s"][0] = 1.0  # the caller's own memory


def test_law_same_seed_same_bits():
    one, same = (windfall.simulate("sage-perturbed", seed=7, threads=n)[0]["record"]["X_m"] for n in (1, 2))
    other = windfall.simulate("sage-perturbed", seed=8)[0]["record"]["X_m"]
    assert np.array_equal(one, same) and not np.array_equal(one, other)


def test_recover_exact_flight_gives_its_parameters():
    found = windfall.identify("appendix-c", method="equation-error")
    combined = next(d for d in found["data_sets"] if d["name"] == "combined")
    estimates = {p["name"]: p["estimate"] for p in combined["parameters"]}
    for name, truth in TABLE_5_5.items():
        assert estimates[name] == pytest.approx(truth, rel=1e-5)
    again = windfall.resimulate(windfall.campaign("appendix-c"), found)
    assert again["trajectory"]["attitude_rms_deg"] < 1e-3


def test_law_method_is_chosen_by_the_data_and_named():
    flown = windfall.campaign("sage-perturbed", seed=7)
    chosen = windfall.identify(flown)
    assert chosen["method"] == "output-error" and "noise" in chosen["reason"]
    named = windfall.identify(flown, method="output-error")
    assert named["data_sets"][-1]["parameters"] == chosen["data_sets"][-1]["parameters"]


def test_law_identify_gives_the_programs_bytes(tmp_path):
    """Values held, compatibility, curves and the reader's notes included: one piece of code behind both."""
    run = program
    run("simulate", "sage-perturbed", "--out", tmp_path)
    (record,) = (p for p in tmp_path.glob("*.csv") if "truth" not in p.name)
    lines = record.read_text().splitlines(keepends=True)
    record.write_text("".join(lines[:500] + lines[502:]))  # a dropout, which the reader notes
    path = tmp_path / "campaign.toml"
    told = run("identify", path, "--json", "--method", "equation-error", "--hold", "Cl_0=0.0125").stdout.decode()
    with pytest.warns(windfall.WindfallWarning, match="bridged"):
        flown = windfall.campaign(path)
    request = {"method": "equation-error", "hold": [{"name": "Cl_0", "value": 0.0125}]}
    assert flown._native.identify(json.dumps(request))[0] == told
    found = windfall.identify(flown, method="equation-error", hold={"Cl_0": 0.0125})
    assert found == json.loads(told)
    assert found["warnings"][0] == flown.warnings[0] and found["compatibility"] and found["data_sets"][0]["curves"]
    with pytest.raises(windfall.WindfallError, match="parameters: CA_T0"):
        windfall.identify(flown, hold={"CX": 1.0})
    with pytest.raises(ValueError, match="prior Cl_p"):
        windfall.identify(flown, prior={"Cl_p": (1.0, 0.0)})
    with pytest.raises(ValueError, match="unknown field `holds`"):
        flown._native.identify('{"holds": []}')


def test_law_keywords_are_those_of_the_requests():
    assert "bootstrap: Check the stated errors" in (windfall.identify.__doc__ or "")
    with pytest.raises(TypeError, match="'metod'; allowed: accept_record, bootstrap, combined, cutoffs"):
        windfall.identify("appendix-c", metod="thesis")
    with pytest.raises(TypeError, match="'seed'; allowed: accept_record"):
        windfall.close("appendix-c", seed=3)


def test_law_the_front_page_runs_as_it_is_printed():
    assert doctest.testmod(windfall) == (0, 6)


def test_law_terms_and_plans_are_the_programs():
    flown = windfall.campaign("sage-perturbed", seed=7)
    terms = windfall.structure(flown, criterion="bic")
    assert terms["criterion"] == "bic" and "CA" in {c["coefficient"] for c in terms["coefficients"]}
    (target,) = windfall.plan(flown, percent={"Cm_2": 50.0})["targets"]
    assert target["parameter"] == "Cm_2"
    assert target["std_error_wanted"] == pytest.approx(0.5 * abs(target["estimate"]))
    with pytest.raises(windfall.IdentifyError, match="Cm_9"):
        windfall.plan(flown, percent={"Cm_9": 5.0})


def test_law_arrays_make_the_campaign_that_files_make():
    flights = windfall.simulate("sage-perturbed", seed=7)
    flown = windfall.campaign("sage-perturbed", seed=7)
    runs = [(f["name"], f["kind"], f["use"], f["record"]) for f in flights]
    a, b = (windfall.identify(c, method="equation-error") for c in (flown, flown.with_runs(runs)))
    pairs = zip(a["data_sets"][0]["parameters"], b["data_sets"][0]["parameters"], strict=True)
    # Degrees and back: rounding only, amplified by two differentiations.
    assert all(p["estimate"] == pytest.approx(q["estimate"], rel=1e-6) for p, q in pairs)
    short = [("x", "perturbed", "identify", {**flights[0]["record"], "X_m": np.zeros(3)})]
    with pytest.raises(ValueError, match="differ in length"):
        flown.with_runs(short)
    with pytest.raises(windfall.ReadError, match="Ts_K: column is missing"):
        flown.with_runs([("x", "perturbed", "identify", {k: v for k, v in flights[0]["record"].items() if k != "Ts_K"})])


def test_law_errors_are_exceptions_of_their_own(tmp_path):
    bad = tmp_path / "bad.toml"
    text = (Path(__file__).parents[2] / "scenarios/bundled/appendix-c.toml").read_text()
    bad.write_text(text.replace("mass_kg = 0.7873", "mass_kg = nan"))
    with pytest.raises(windfall.ReadError, match="mass_kg = nan") as caught:
        windfall.simulate(bad)
    (fault,) = caught.value.faults
    assert fault["key"] == "[vehicle] mass_kg" and fault["line"] > 1 and fault["remedy"]
    falling = tmp_path / "falling.toml"
    drop = (Path(__file__).parents[2] / "scenarios/bundled/drop-test.toml").read_text()
    falling.write_text(drop.replace("CA_T0 = 6.6620", "CA_T0 = -60.0"))
    with pytest.raises(windfall.SimulateError):
        windfall.simulate(falling)
    with pytest.raises(ValueError, match="^method = 'oe': allowed: thesis, equation-error, output-error, filter-error$"):
        windfall.identify("appendix-c", method="oe")
    with pytest.raises(ValueError, match="^identification: is the result of windfall close; needed here: the result of windfall identify"):
        windfall.resimulate("appendix-c", {"verdict": "effect", "effects": []})
    with pytest.raises(windfall.ReadError, match="nowhere"):
        windfall.campaign("nowhere/campaign.toml")
    every = [windfall.ReadError, windfall.WriteError, windfall.SimulateError, windfall.IdentifyError]
    assert all(issubclass(e, windfall.WindfallError) for e in [*every, windfall.LoopError, windfall.StudyError])


def test_law_study_in_whole_in_shards_and_resumed(tmp_path):
    path = study_file(tmp_path)
    summary = windfall.study(path, tmp_path / "one", threads=1)
    assert summary["draws"] == 40 and summary["failures"]["any"]["count"] == 0
    for i in (2, 1):
        assert windfall.study(path, tmp_path / "shards", shard=(i, 2)) is None
    again = windfall.study(path, tmp_path / "shards", resume=True)
    assert again == summary and files(tmp_path / "shards") == files(tmp_path / "one")
    with pytest.raises(windfall.StudyError, match="--resume"):
        windfall.study(path, tmp_path / "one")
    runs = windfall.read_runs(tmp_path / "one" / "runs.parquet")
    errors = runs["equation-error.CA.CA_T0.error"]
    assert np.array_equal(runs["draw"], np.arange(40)) and runs["failure"] == [""] * 40
    line = next(p for p in summary["parameters"] if p["name"] == "CA_T0")
    # Two roads to the same numbers: NumPy's and the program's. Draws that refuse a parameter have no error of it.
    errors = errors[np.isfinite(errors)]
    assert len(errors) > 20 and line["bias"] == pytest.approx(errors.mean(), rel=1e-9, abs=1e-15)
    assert line["scatter"] == pytest.approx(errors.std(ddof=1), rel=1e-9)
    assert json.loads((tmp_path / "one" / "summary.json").read_text())["parameters"] == summary["parameters"]


def test_law_other_threads_run_meanwhile(tmp_path):
    """The interpreter's lock is released: a thread ticks on while a study is drawn."""
    order = _windfall.Study(str(study_file(tmp_path, draws=100, part=100)))
    ticks, over = [], threading.Event()

    def tick():
        while not over.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    order.part(0)
    end = time.perf_counter()
    over.set()
    thread.join()
    assert sum(begin < t < end for t in ticks) >= 5


def heed() -> None:
    """What runs in the background of a shell inherits a SIGINT that is ignored, and Python then leaves it so."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupted_program(words, begun) -> tuple[int, float]:
    """Exit code, and seconds from SIGINT, of a program; sent once `begun()` is true."""
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=heed)
    while not begun():
        assert child.poll() is None
        time.sleep(0.002)
    sent = time.perf_counter()
    child.send_signal(signal.SIGINT)
    return child.wait(timeout=60), time.perf_counter() - sent


def interrupted(script: str, begun) -> float:
    """Seconds from SIGINT to the end of a script that must end by KeyboardInterrupt; sent once `begun()` is true."""
    child = subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.PIPE, text=True, preexec_fn=heed)
    while not begun(child):
        assert child.poll() is None, child.stderr.read()
        time.sleep(0.002)
    sent = time.perf_counter()
    child.send_signal(signal.SIGINT)
    _, errors = child.communicate(timeout=60)
    took = time.perf_counter() - sent
    assert child.returncode != 0 and "KeyboardInterrupt" in errors, errors
    return took


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process")
def test_law_an_interrupted_study_raises_soon_and_resumes(tmp_path):
    path = study_file(tmp_path, draws=4000, part=16)
    parts = tmp_path / "stopped" / "parts"
    script = f"import windfall; windfall.study({str(path)!r}, {str(tmp_path / 'stopped')!r}, threads=2)"
    # Draws in flight take milliseconds; the rest is for a busy machine.
    assert interrupted(script, lambda _: len(list(parts.glob("*.parquet"))) >= 2) < 2.0
    assert not (tmp_path / "stopped" / "runs.parquet").exists()
    assert windfall.study(path, tmp_path / "stopped", resume=True) == windfall.study(path, tmp_path / "whole")
    assert files(tmp_path / "stopped") == files(tmp_path / "whole")


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process")
def test_law_an_interrupted_close_raises_at_once(tmp_path):
    flag = tmp_path / "begun"
    script = (
        "import pathlib, windfall; c = windfall.campaign('sage-undeclared');"
        f"pathlib.Path({str(flag)!r}).touch(); windfall.close(c)"
    )
    assert interrupted(script, lambda _: flag.exists()) < 2.0


def test_law_an_interrupt_in_another_handler_reaches_it():
    """Signals are looked at while the rooms work: an alarm's exception ends a call that takes longer."""
    if not hasattr(signal, "setitimer"):
        pytest.skip("no alarms here")

    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    flown = windfall.campaign("sage-undeclared")
    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            windfall.close(flown)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_law_verbs_on_files(tmp_path):
    kind, warnings = windfall.check("sage-combined")
    assert (kind, warnings) == ("scenario", [])
    with pytest.raises(windfall.ReadError):
        windfall.check(tmp_path / "none.toml")
    verified = windfall.verify()
    assert verified["verdict"] == "pass" and len(verified["checks"]) > 50
    (tmp_path / "verify.json").write_text(json.dumps(verified))
    assert windfall.report(tmp_path).startswith("<!DOCTYPE html>")
    with pytest.raises(windfall.WindfallError):
        windfall.report(tmp_path / "empty")


def target_program() -> Path:
    """The program beside the package, or skips."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", Path(__file__).parents[2] / "target"))
    path = target / "debug" / "windfall"
    if not path.exists():
        pytest.skip("no program beside the package: cargo build")
    return path


def program(*words):
    return subprocess.run([target_program(), *words, "--quiet"], check=True, capture_output=True)


def campaigns(folder: Path, count: int) -> Path:
    """So many campaigns of one flight of 2 s, with other masses declared; one that cannot be read."""
    study_file(folder)
    program("simulate", folder / "short.toml", "--out", folder / "flown")
    text = (folder / "flown/campaign.toml").read_text()
    (run,) = (p for p in (folder / "flown").glob("*.csv") if "truth" not in p.name)
    for k in range(count):
        own = folder / "all" / f"c{k:02}"
        own.mkdir(parents=True)
        (own / run.name).write_bytes(run.read_bytes())
        (own / "campaign.toml").write_text(text.replace("mass_kg = 0.7", f"mass_kg = 0.7{k:02}"))
    (folder / "all/bad").mkdir()
    (folder / "all/bad/campaign.toml").write_text(text.replace("mass_kg", "mas_kg"))
    return folder / "all"


def tree(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_law_many_campaigns_give_the_programs_bytes(tmp_path):
    found = campaigns(tmp_path, 4)
    program("many", "identify", found, "--out", tmp_path / "told", "--method", "equation-error", "--hold", "Cl_0=0.0125")
    request = {"method": "equation-error", "hold": {"Cl_0": 0.0125}}
    summary = windfall.many("identify", found, tmp_path / "own", **request)
    assert summary is not None and (summary["ok"], summary["failed"]) == (4, 1)
    assert tree(tmp_path / "own") == tree(tmp_path / "told") and "results/c03/identification.json" in tree(tmp_path / "own")
    assert summary == json.loads((tmp_path / "own/many.json").read_text())
    for i in (2, 1):
        assert windfall.many("identify", found, tmp_path / "shards", shard=(i, 2), **request) is None
    assert windfall.many("identify", found, tmp_path / "shards", resume=True, **request) == summary
    assert tree(tmp_path / "shards") == tree(tmp_path / "own")
    masses = [o["parameters"][0]["estimate"] for o in summary["outcomes"][1:]]
    # The same accelerations of larger masses are larger coefficients: C_A grows with the mass, and the pooled mean lies between.
    assert masses == sorted(masses) and masses[0] < summary["pooled"][0]["mean"] < masses[-1]
    with pytest.raises(windfall.StudyError, match="--resume"):
        windfall.many("identify", found, tmp_path / "own", **request)
    with pytest.raises(ValueError, match="no campaign.toml"):
        windfall.many("close", tmp_path / "own", tmp_path / "none")
    with pytest.raises(ValueError, match="expected `close` or `identify`"):
        windfall.many("plan", found, tmp_path / "none")
    files_alone = [found / "c00/campaign.toml", found / "c01/campaign.toml"]
    two = windfall.many("identify", files_alone, tmp_path / "two", **request)
    assert two is not None and [o["path"] for o in two["outcomes"]] == ["c00/campaign.toml", "c01/campaign.toml"]
    assert windfall.report(tmp_path / "two").encode() == (tmp_path / "two/report.html").read_bytes()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process")
def test_law_many_interrupted_raise_soon_and_resume(tmp_path):
    found = campaigns(tmp_path, 6)
    out = tmp_path / "stopped"
    script = f"import windfall; windfall.many('close', {str(found)!r}, {str(out)!r}, threads=1)"
    # 0.7 s are waited for the campaign in flight; the rest is for a busy machine.
    assert interrupted(script, lambda _: len(list(out.glob("results/*/outcome.json"))) >= 2) < 2.0
    assert not (out / "many.json").exists()
    assert windfall.many("close", found, out, resume=True) == windfall.many("close", found, tmp_path / "whole")
    assert tree(out) == tree(tmp_path / "whole")


def test_law_first_minutes_are_the_programs(tmp_path):
    flown = program("simulate", "sage-perturbed", "--out", tmp_path)
    assert flown.returncode == 0
    (run,) = (p for p in tmp_path.glob("*.csv") if "truth" not in p.name)
    program("init", tmp_path / "mine", run)
    assert windfall.init(run) == (tmp_path / "mine/campaign.toml").read_text()
    text = windfall.explain("center-of-mass", "mass_kg")
    assert text == json.loads(program("explain", "center-of-mass", "mass_kg", "--json").stdout)["text"] and "kg" in text
    with pytest.raises(ValueError, match="no family of effects, no key and no word of the screen"):
        windfall.explain("nothing-of-ours")
    with pytest.raises(windfall.ReadError):
        windfall.init(tmp_path / "none.csv")


def test_law_a_bar_counts_parts_and_campaigns(tmp_path, capfd):
    pytest.importorskip("tqdm")
    windfall.study(study_file(tmp_path), tmp_path / "out", progress=True)
    assert "5/5" in capfd.readouterr().err
    windfall.many("identify", campaigns(tmp_path, 3), tmp_path / "many", progress=True, method="equation-error")
    assert "4/4" in capfd.readouterr().err
