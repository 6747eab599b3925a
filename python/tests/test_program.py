"""The program that the package brings: the built one's words, exit codes and end by Ctrl-C; which of its flags Python has."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import windfall
from test_windfall import interrupted_program, program, study_file, target_program
from windfall import _requests

INSTALLED = Path(sys.executable).parent / "windfall"
ROOT = Path(__file__).parents[2]


def both(*words):
    """Exit code, output and talk of the built and of the installed program."""
    return [subprocess.run([p, *words], capture_output=True) for p in (target_program(), INSTALLED)]


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--version"], 0),
        (["--help"], 0),
        ([], 2),
        (["identify", "--method", "magic", "x"], 2),
        (["check", "appendix-c"], 0),
        (["check", "nowhere.toml"], 2),
        (["explain", "mass_kg", "--json"], 0),
        (["completions", "bash"], 0),
        (["simulate", "sage-perturbed", "--json", "--threads", "513"], 2),
        (["simulate", "appendix-c", "--json"], 0),
        (["close", "--statistics", "nowhere"], 2),
    ],
)
def test_law_the_installed_program_is_the_built_one(words, code):
    built, installed = both(*words)
    assert built.returncode == installed.returncode == code
    assert (built.stdout, built.stderr) == (installed.stdout, installed.stderr)


def test_law_a_module_is_the_program_too():
    ran = subprocess.run([sys.executable, "-m", "windfall", "--version"], capture_output=True, text=True)
    assert ran.stdout == f"windfall {windfall.__version__}\n"


def test_law_a_failed_flight_is_the_same_code(tmp_path):
    drop = (ROOT / "scenarios/bundled/drop-test.toml").read_text()
    (tmp_path / "falling.toml").write_text(drop.replace("CA_T0 = 6.6620", "CA_T0 = -60.0"))
    built, installed = both("simulate", tmp_path / "falling.toml", "--json")
    assert built.returncode == installed.returncode == 3 and built.stderr == installed.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT cannot be sent to one process")
def test_law_ctrl_c_ends_the_installed_program(tmp_path):
    """A verb with nothing to bring to an end is ended by the signal itself; a study keeps what is drawn and says 130."""
    code, took = interrupted_program([INSTALLED, "close", "sage-undeclared", "--json"], lambda: time.sleep(1.0) or True)
    assert code == -signal.SIGINT and took < 1.0
    path = study_file(tmp_path, draws=4000, part=16)
    parts = tmp_path / "out/parts"
    code, took = interrupted_program(
        [INSTALLED, "study", path, "--out", tmp_path / "out"], lambda: len(list(parts.glob("*.parquet"))) > 1
    )
    assert code == 130 and took < 2.0 and not (tmp_path / "out/runs.parquet").exists()
    ran = subprocess.run([INSTALLED, "study", path, "--out", tmp_path / "out", "--resume", "--quiet"], capture_output=True)
    assert ran.returncode == 0, ran.stderr


#: Flags that are no keyword of a request, and what Python has in their place.
IN_PLACE = {
    "out": "`to_json()`; `out` where files are made on the way",
    "force": "`force` beside `out`",
    "json": "`to_json()`",
    "quiet": "`warnings`",
    "threads": "`threads`",
    "target": "`percent`, `absolute`",
    "model": "the second argument",
    "statistics": "`close_statistics`",
    "figures": "`figures`",
    "width": "`width`",
    "keys": "`keys()`",
}


def parity() -> str:
    """Every verb and flag of the program beside what Python has, as Markdown."""
    lines = ["# Program and Python", "", "Made by a test of the package from docs/reference/flags.md; do not edit.", ""]
    lines += ["| program | Python |", "|---|---|"]
    verb, common = "", False
    for line in (ROOT / "docs/reference/flags.md").read_text().splitlines():
        if line.startswith("## "):
            verb, common = line.removeprefix("## `windfall ").rstrip("`"), line == "## Every verb"
            if verb in ("completions", "manual"):
                lines.append(f"| `windfall {verb}` | the program's own: `pip install` brings it |")
            elif not common:
                name, *each = verb.split()
                function = getattr(windfall, name)
                lines.append(
                    f"| `windfall {verb}` | `windfall.{function.__name__}({', '.join(repr(e) for e in each)}{', ' if each else ''}…)` |"
                )
        elif line.startswith("- `--"):
            flag = line.split("`")[1].split()[0].removeprefix("--")
            request = _requests.__dict__.get({"simulate": "Fly"}.get(verb, verb.split()[-1].capitalize() if verb else ""))
            fields = (
                {}
                if request is None or common
                else {**request.__annotations__, **(_requests.Many.__annotations__ if verb.startswith("many") else {})}
            )
            field = flag.replace("-", "_")
            here = f"`{field}`" if field in fields else IN_PLACE.get(flag)
            assert here is not None, f"windfall {verb} --{flag}: Python lacks it"
            lines.append(f"| {'every verb' if common else verb} `--{flag}` | {here} |")
    return "\n".join(lines) + "\n"


def test_law_python_has_every_verb_and_flag():
    path = ROOT / "docs/reference/parity.md"
    now = parity()
    if os.environ.get("WINDFALL_WRITE_REFERENCE"):
        path.write_text(now)
    assert path.read_text() == now, "run `just references`"


def test_law_absurd_threads_are_refused():
    for threads, error in ((513, ValueError), (-1, ValueError), (10**30, ValueError), (1.5, TypeError), (True, TypeError)):
        with pytest.raises(error, match="threads = "):
            windfall.identify("appendix-c", threads=threads)
    with pytest.raises(ValueError, match="threads = 9999"):
        windfall._windfall.verify(9999)


def test_law_keys_and_figures_are_the_programs(tmp_path):
    assert windfall.keys() == program("check", "--keys").stdout.decode()
    program("verify", "--out", tmp_path / "made")
    program("simulate", "sage-perturbed", "--out", tmp_path / "made")
    program("identify", tmp_path / "made/campaign.toml", "--combined", "--out", tmp_path / "made")
    program("report", tmp_path / "made", "--figures", tmp_path / "told", "--width", "100")
    page = windfall.report(tmp_path / "made", figures=tmp_path / "own", width=100.0)
    assert page == (tmp_path / "made/report.html").read_text()
    told, own = ({p.name: p.read_bytes() for p in (tmp_path / f).iterdir()} for f in ("told", "own"))
    assert told == own and len(own) >= 3
    with pytest.raises(windfall.WriteError, match="not overwritten"):
        windfall.report(tmp_path / "made", figures=tmp_path / "own")
    with pytest.raises(ValueError, match="allowed: 60 to 400 mm"):
        windfall.report(tmp_path / "made", figures=tmp_path / "own", width=20.0, force=True)
