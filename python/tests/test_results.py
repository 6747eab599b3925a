"""Results as typed classes: of the program's bytes, with every field, picklable, shown and drawn."""

import pickle
import subprocess
import sys
import types
import typing
from pathlib import Path

import pytest
import windfall
from test_windfall import campaigns, program, study_file, target_program
from windfall import results

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """A result of every kind that is soon there."""
    folder = tmp_path_factory.mktemp("results")
    program("simulate", "sage-perturbed", "--out", folder)
    campaign = windfall.campaign(folder / "campaign.toml")
    identified = windfall.identify(campaign, combined=True)
    return folder, {
        "identify": identified,
        "resimulate": windfall.resimulate(campaign, identified, draws=4),
        "close": windfall.close(campaign),
        "structure": windfall.structure(campaign, criterion="bic"),
        "plan": windfall.plan(campaign, percent={"Cm_2": 0.05}),
        "verify": windfall.verify(),
        "descend": windfall.descend("venus-dispersions", draws=20),
        "study": windfall.study(study_file(folder), folder / "study"),
        "many": windfall.many(
            "identify", campaigns(tmp_path_factory.mktemp("many"), 2), folder / "many", method="equation-error"
        ),
    }


def test_law_the_types_are_the_programs():
    """The stored types are those of the structs; after a change: `just references`."""
    now = subprocess.run(
        [sys.executable, ROOT / "scripts/result-types", "--print"], capture_output=True, text=True, check=True
    ).stdout
    assert (ROOT / "python/py/windfall/results.py").read_text() == now, "run `just references`"
    exported = {name for name in vars(results) if isinstance(vars(results)[name], type) and issubclass(vars(results)[name], dict)}
    assert exported == set(results.__all__)


def holds(hint, value) -> bool:
    """Whether a value is of a type, all the way down."""
    origin, of = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return any(holds(t, value) for t in of)
    if origin is list:
        return isinstance(value, list) and all(holds(of[0], x) for x in value)
    if origin is dict:
        return isinstance(value, dict)
    if origin is typing.Literal:
        return value in of
    if hint is float:  # what is not finite is null
        return isinstance(value, (float, int)) or value is None
    if hint in (typing.Any, None, type(None)):
        return hint is typing.Any or value is None
    if issubclass(hint, results.Record):
        return type(value) is hint and fits(value)
    return isinstance(value, hint)


def fits(record) -> bool:
    hints = typing.get_type_hints(type(record))
    assert set(record) <= set(hints), f"{type(record).__name__}: {set(record) - set(hints)}"
    wrong = [
        f"{type(record).__name__}.{n} = {getattr(record, n)!r:.80}" for n, h in hints.items() if not holds(h, getattr(record, n))
    ]
    wrong = [w for w in wrong if "= None" not in w]  # left out by the program
    assert not wrong, wrong
    return True


def test_law_every_field_has_the_type_that_it_says(found):
    for verb, result in found[1].items():
        assert fits(result), verb


def test_law_json_is_the_programs_to_the_byte(found):
    folder, all_found = found
    campaign = folder / "campaign.toml"
    for verb, words in {
        "identify": [campaign, "--combined"],
        "close": [campaign],
        "structure": [campaign, "--criterion", "bic"],
        "plan": [campaign, "--target", "Cm_2=0.05%"],
    }.items():
        assert all_found[verb].to_json() == program(verb, *words, "--json").stdout.decode(), verb
    (folder / "identification.json").write_text(all_found["identify"].to_json())
    told = program("resimulate", campaign, "--model", folder / "identification.json", "--draws", "4", "--json").stdout.decode()
    assert all_found["resimulate"].to_json() == told
    told = program("study", folder / "study.toml", "--out", folder / "study", "--resume", "--json").stdout.decode()
    assert all_found["study"].to_json() == told
    assert all_found["many"].to_json() == (folder / "many/many.json").read_text()
    told = program("descend", "venus-dispersions", "--draws", "20", "--json").stdout.decode()
    assert all_found["descend"].to_json() == told


def test_law_results_are_pickled_shown_and_drawn(found, tmp_path):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    pytest.importorskip("matplotlib")
    for verb, result in found[1].items():
        again = pickle.loads(pickle.dumps(result))
        assert type(again) is type(result) and again == result and again.to_json() == result.to_json(), verb
        rows = result.rows()
        frame = result.to_frame()
        assert isinstance(frame, pandas.DataFrame) and len(frame) == len(rows) > 0, verb
        assert isinstance(result.to_xarray(), xarray.Dataset), verb
        assert result._repr_html_().count("<tr>") == len(rows) + 1, verb
        png = result.plot()._repr_png_()
        assert png.startswith(b"\x89PNG") and len(png) > 5000, verb
    frame = found[1]["identify"].to_frame().set_index("name")
    (drag,) = (p for p in found[1]["identify"].data_sets[0].parameters if p.name == "CA_T0")
    assert frame.loc["CA_T0", "estimate"] == drag.estimate
    dataset = found[1]["identify"].to_xarray()
    assert dataset["estimate"].where(dataset["name"] == "CA_T0", drop=True).values.tolist() == [drag.estimate]
    assert found[1]["verify"].to_xarray().sizes == {"id": len(found[1]["verify"].checks)}


def test_law_words_of_files_are_not_code():
    shown = results.Closing(
        {"campaign": "<script>", "verdict": "consistent", "effects": [], "after": {"parameters": []}}
    )._repr_html_()
    assert "<script>" not in shown and "&lt;script&gt;" in shown


def test_law_flights_are_tables_too():
    (flight,) = windfall.simulate("appendix-c")
    frame, dataset = flight.to_frame(), flight.to_xarray()
    assert list(frame.columns)[:2] == ["t_s", "X_m"] and len(frame) == 2251
    assert dataset["true_p_tunnel_cm_m"].shape == (2251, 3) and float(dataset["X_m"][7]) == flight.record["X_m"][7]
    assert flight.plot()._repr_png_().startswith(b"\x89PNG") and "2251 samples" in flight._repr_html_()
    again = pickle.loads(pickle.dumps(flight))
    assert type(again) is windfall.Flight and again.end_t_s == flight.end_t_s


def test_law_what_is_left_out_is_none_or_empty():
    found = results.Identification({"method": "thesis", "data_sets": [{"name": "x", "parameters": []}]})
    assert found.reason is None and found.warnings == [] and found.data_sets[0].covariance == []
    with pytest.raises(AttributeError):
        found.estimates


def test_law_a_field_named_like_a_method_of_dictionaries_is_the_field():
    found = results.Study({"varied": [{"name": "mass_kg", "values": [0.7, 0.8]}]})
    again = pickle.loads(pickle.dumps(found))
    assert found.varied[0].values == again.varied[0].values == again["varied"][0]["values"] == [0.7, 0.8]


def test_law_printed_is_what_the_terminal_prints(found):
    """`print(result)` after the program's own output, verb by verb; a result of a file has no such words and prints as a dictionary."""
    folder, by_verb = found
    campaign, model = folder / "campaign.toml", folder / "model.json"
    model.write_text(by_verb["identify"].to_json())
    for verb, words in {
        "identify": [campaign, "--combined"],
        "resimulate": [campaign, "--model", model, "--draws", "4"],
        "close": [campaign],
        "structure": [campaign, "--criterion", "bic"],
        "plan": [campaign, "--target", "Cm_2=0.05%"],
        "verify": [],
        "descend": ["venus-dispersions", "--draws", "20"],
    }.items():
        # A plan out of reach, or a closing that finds something, is no failure here.
        told = subprocess.run([target_program(), verb, *words, "--quiet"], capture_output=True, text=True)
        assert told.returncode <= 1 and f"{by_verb[verb]}\n" == told.stdout, (verb, told.stderr)
    assert "bias" in str(by_verb["study"]) and str(by_verb["many"]).startswith("3 campaigns: 2 with a result")
    again = pickle.loads(pickle.dumps(by_verb["identify"]))
    assert str(again) == str(by_verb["identify"])
    assert str(results.Identification({"method": "x"})) == repr(results.Identification({"method": "x"}))


def test_law_warnings_of_the_estimator_are_warnings(tmp_path):
    """A lander whose centre of mass is 0.3 mm off: the residual is no noise, which the terminal warns of and Python does as well."""
    scenario = (ROOT / "scenarios/bundled/sage-perturbed.toml").read_text()
    (tmp_path / "s.toml").write_text(scenario + "\n[effects.center-of-mass]\ny_m = 0.0003\n")
    program("simulate", tmp_path / "s.toml", "--out", tmp_path / "flown")
    campaign = windfall.campaign(tmp_path / "flown/campaign.toml")
    with pytest.warns(windfall.WindfallWarning) as said:
        found = windfall.identify(campaign, method="output-error", combined=True)
    told = [str(w.message) for w in said]
    assert told == found.warnings[len(campaign.warnings) :] and any("not noise" in w for w in told)
    assert all(w.filename == __file__ for w in said), "said where the user called from"


def test_law_a_probability_is_at_most_one(found):
    for effect in windfall.close("sage-undeclared").effects:
        assert 0.0 <= effect.probability <= 1.0
