"""Tables and documents in the place of files: the files' numbers, and the files' faults."""

import dataclasses
import json
import pickle
import tomllib
from pathlib import Path

import numpy as np
import pytest
import windfall
from test_windfall import files, program, study_file

ROOT = Path(__file__).parents[2]
METHOD = {"method": "equation-error", "combined": True}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A folder with a campaign of one flight; its document, its record."""
    folder = tmp_path_factory.mktemp("flown")
    program("simulate", "sage-perturbed", "--out", folder)
    document = tomllib.loads((folder / "campaign.toml").read_text())
    (record,) = (f["record"] for f in windfall.simulate("sage-perturbed"))
    return folder, document, record


def tables(record):
    """The record as a table of every kind, by the kind's name."""
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    pyarrow, xarray = pytest.importorskip("pyarrow"), pytest.importorskip("xarray")
    frame = pandas.DataFrame(record)
    series = {name: ("t_s", x) for name, x in record.items() if name != "t_s"}
    rows = np.zeros(len(record["t_s"]), dtype=[(name, "f8") for name in record])
    for name, x in record.items():
        rows[name] = x
    return {
        "arrays": record,
        "lists": {name: x.tolist() for name, x in record.items()},
        "rows": frame.to_dict("records"),
        "structured": rows,
        "pandas": frame,
        "pandas with an index": frame.set_index("t_s"),
        "pandas, columns of Arrow": frame.convert_dtypes(dtype_backend="pyarrow"),
        "polars": polars.DataFrame(record),
        "polars, lazy": polars.LazyFrame(record),
        "arrow": pyarrow.table(record),
        "xarray": xarray.Dataset(series, coords={"t_s": record["t_s"]}),
    }


def with_table(document, table, **run):
    return {**document, "run": [{"name": "run", **document["run"][0], "file": table, **run}]}


def test_law_every_table_is_the_file(flown):
    folder, document, record = flown
    expected = windfall.identify(folder / "campaign.toml", **METHOD).to_json()
    for kind, table in tables(record).items():
        assert windfall.identify(with_table(document, table), **METHOD).to_json() == expected, kind
    single = {name: x.astype(np.float32) for name, x in record.items()}
    # Times of single precision are 1e-6 s off at 18 s: the record is the same to what it is sampled by.
    near = windfall.identify(with_table(document, single), **METHOD).data_sets[0].parameters[0]
    assert near.estimate == pytest.approx(6.662, rel=1e-3)


def test_law_with_runs_is_the_file(flown):
    folder, document, record = flown
    campaign = windfall.campaign(folder / "campaign.toml")
    expected = windfall.identify(campaign, **METHOD).to_json()
    alone = windfall.identify(campaign.with_runs({"run": record}), **METHOD)
    assert [p.estimate for p in alone.data_sets[0].parameters] == [
        p["estimate"] for p in json.loads(expected)["data_sets"][0]["parameters"]
    ]
    for runs in ([("run", "perturbed", "identify", record)], [{"name": "run", "data": record, "kind": "perturbed"}]):
        assert windfall.identify(campaign.with_runs(runs), **METHOD).to_json() == expected
    with pytest.raises(ValueError, match="one of identify, select, hold-out"):
        campaign.with_runs([("run", "perturbed", "learn", record)])
    with pytest.raises(TypeError, match="no colour; allowed: name, kind, use, data"):
        campaign.with_runs([{"name": "run", "data": record, "colour": "red"}])
    with pytest.raises(ValueError, match="run: appears twice"):
        campaign.with_runs([("run", "perturbed", "identify", record)] * 2)
    with pytest.raises(TypeError, match="float is no table"):
        campaign.with_runs({"run": 3.0})


#: What a user can get wrong, and what the reader of files says of it.
WRONG = {
    "kPa for Pa": (lambda r: {**r, "ps_Pa": r["ps_Pa"] / 1e3}, "ps_Pa = 101.3"),
    "deg C for K": (lambda r: {**r, "Ts_K": r["Ts_K"] - 273.15}, "Ts_K = 25.9"),
    "km/h for m/s": (lambda r: {**r, "VW_m_s": r["VW_m_s"] * 3.6}, "V_W looks like km/h"),
    "backwards": (lambda r: {n: x[::-1] for n, x in r.items()}, "time goes backward"),
    "a column lacks": (lambda r: {n: x for n, x in r.items() if n != "Ts_K"}, "Ts_K: column is missing"),
    "words": (lambda r: {**r, "Ts_K": ["warm"] * len(r["t_s"])}, "Ts_K: column is missing"),
    "empty": (lambda r: {n: x[:0] for n, x in r.items()}, "no rows|0 samples"),
    "one sample": (lambda r: {n: x[:1] for n, x in r.items()}, "samples"),
}


@pytest.mark.filterwarnings("ignore:.*no plain numbers")
@pytest.mark.parametrize("what", WRONG)
def test_law_what_files_are_refused_for_tables_are_refused_for(flown, what):
    folder, document, record = flown
    change, said = WRONG[what]
    with pytest.raises(windfall.ReadError, match=said) as alone:
        windfall.campaign(folder / "campaign.toml").with_runs({"run": change(record)})
    with pytest.raises(windfall.ReadError, match=said) as whole:
        windfall.campaign(with_table(document, change(record)))
    for caught in (alone, whole):
        assert "windfall-" not in str(caught.value) and caught.value.faults[0]["file"] in ("run", "run.csv")


def test_law_what_reading_says_arrives_as_warnings(flown):
    folder, document, record = flown
    hole = {n: np.delete(x, [500, 501]) for n, x in record.items()}
    with pytest.warns(windfall.WindfallWarning) as said:
        campaign = windfall.campaign(folder / "campaign.toml").with_runs({"run": hole})
    assert str(said[0].message).startswith("run: X_m: 2 samples bridged") and said[0].filename == __file__
    with pytest.warns(windfall.WindfallWarning) as said:
        again = windfall.campaign(with_table(document, hole))
    assert [str(w.message) for w in said] == campaign.warnings
    assert (
        campaign.warnings == again.warnings
        and windfall.identify(again, **METHOD).warnings[: len(again.warnings)] == again.warnings
    )
    with pytest.warns(windfall.WindfallWarning, match="no plain numbers: day"):
        windfall.campaign(with_table(document, {**record, "day": np.full(len(record["t_s"]), "2026-11-23", "M8[D]")}))


@dataclasses.dataclass
class Study:
    """A study of one's own."""

    study: dict
    do: dict
    note: None = None


def test_law_documents_are_the_files(tmp_path):
    path = study_file(tmp_path)
    study, short = (tomllib.loads((tmp_path / f).read_text()) for f in ("study.toml", "short.toml"))
    expected = windfall.study(path, tmp_path / "one")
    study["study"]["scenario"] = short
    assert windfall.study(study, tmp_path / "mapping") == expected
    assert windfall.study(Study(**study), tmp_path / "dataclass") == expected
    assert files(tmp_path / "mapping")[0] == files(tmp_path / "one")[0] == files(tmp_path / "dataclass")[0]
    (a,), (b,) = windfall.simulate(tmp_path / "short.toml"), windfall.simulate(short)
    assert all(np.array_equal(a.record[n], b.record[n]) for n in a.record)
    assert windfall.check(short) == windfall.check(tmp_path / "short.toml")
    short["vehicle"]["mass_kg"] = float("nan")
    with pytest.raises(windfall.ReadError, match=r"^scenario.toml: \[vehicle\] mass_kg = nan") as caught:
        windfall.simulate(short)
    assert caught.value.faults[0]["line"] is None
    with pytest.raises(TypeError, match="set has no place in a document"):
        windfall.simulate({"scenario": {"name": {1, 2}}})


def test_law_structures_are_documents_too(tmp_path):
    """A vehicle whose aerodynamic terms are a file of its own: by name, and written out."""
    folder = ROOT / "scenarios/capsule"
    document = tomllib.loads((folder / "scenario.toml").read_text())
    (name,) = document["aero"]
    structure = folder / document["aero"][name]["structure"]
    (expected,) = (f.record["X_m"] for f in windfall.simulate(folder / "scenario.toml")[:1])
    for given in (structure, tomllib.loads(structure.read_text())):
        document["aero"][name]["structure"] = given
        assert np.array_equal(windfall.simulate(document)[0].record["X_m"], expected)


def test_law_campaigns_are_pickled_with_their_files(flown, tmp_path):
    folder, document, record = flown
    moved = tmp_path / "moved"
    moved.mkdir()
    for path in folder.iterdir():
        (moved / path.name).write_bytes(path.read_bytes())
    expected = windfall.identify(folder / "campaign.toml", **METHOD).to_json()
    given = [moved / "campaign.toml", with_table(document, record), "sage-perturbed"]
    campaigns = [windfall.campaign(g) for g in given]
    campaigns.append(campaigns[0].with_runs({"run": record}))
    bytes_of = [pickle.dumps(c) for c in campaigns]
    for path in moved.iterdir():
        path.unlink()
    for data, campaign in zip(bytes_of, campaigns, strict=True):
        assert windfall.identify(pickle.loads(data), **METHOD).to_json() == windfall.identify(campaign, **METHOD).to_json()
    assert windfall.identify(pickle.loads(bytes_of[0]), **METHOD).to_json() == expected
    assert json.loads(expected)["method"] == "equation-error"
