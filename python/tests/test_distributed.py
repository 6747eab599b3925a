"""Studies and many campaigns on a cluster of three worker processes, one of them killed midway: the one-machine result byte for byte."""

import os
import signal
import threading
import time

import pytest
import windfall
from test_windfall import campaigns, files, study_file, tree
from windfall._inputs import Packed
from windfall.distributed import many, partition, run

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture
def client():
    with (
        distributed.LocalCluster(n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def killed_midway(client, done, first, last):
    """Kills a worker when `first` pieces are done; the event says that fewer than `last` were by then."""
    pids, killed = list(client.run(os.getpid).values()), threading.Event()

    def kill():
        while done() < first:
            time.sleep(0.002)
        os.kill(pids[0], signal.SIGKILL)
        if done() < last:
            killed.set()

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    return killer, killed


def test_law_a_killed_worker_changes_nothing(tmp_path, client):
    path = study_file(tmp_path, draws=480, part=8)
    windfall.study(path, tmp_path / "one")
    # Sixty parts in all: when it was killed there was still work.
    killer, killed = killed_midway(client, lambda: len(list((tmp_path / "many/parts").glob("*.parquet"))), 5, 50)
    summary = run(path, client, tmp_path / "many")
    killer.join(timeout=10)
    assert killed.is_set()
    assert summary["draws"] == 480
    assert files(tmp_path / "many") == files(tmp_path / "one")


def test_law_stopping_rule_and_resume_on_a_cluster(tmp_path, client):
    rule = '[stop]\ncolumn = "equation-error.CA.CA_T0.error"\nhalf_width = 4e-4\nleast_draws = 16\n'
    path = study_file(tmp_path, draws=400, part=8, more=rule)
    summary = windfall.study(path, tmp_path / "one")
    assert summary["stopped_early"]
    windfall.study(path, tmp_path / "many", shard=(2, 5))
    assert run(path, client, tmp_path / "many", resume=True) == summary
    assert files(tmp_path / "many") == files(tmp_path / "one")


def test_law_a_pack_has_every_file_that_the_study_reads(tmp_path):
    path = study_file(tmp_path)
    (tmp_path / "below").mkdir()
    (tmp_path / "short.toml").rename(tmp_path / "below" / "short.toml")
    path.write_text(path.read_text().replace("short.toml", "below/short.toml"))
    packed = Packed(path)
    assert packed.name == "study.toml"
    assert list(packed.files) == ["study.toml", "below/short.toml"]


def test_law_many_campaigns_on_a_cluster(tmp_path, client):
    """A worker killed midway changes nothing; what came back is not done again, and what cannot be read is a row."""
    found = campaigns(tmp_path, 40)
    request = {"method": "output-error", "combined": True}
    summary = windfall.many("identify", found, tmp_path / "one", **request)
    # Forty-one campaigns: when it was killed there was still work.
    killer, killed = killed_midway(client, lambda: len(list((tmp_path / "many/results").glob("*/outcome.json"))), 4, 36)
    assert many("identify", found, client, tmp_path / "many", **request) == summary
    killer.join(timeout=10)
    assert killed.is_set()
    assert tree(tmp_path / "many") == tree(tmp_path / "one")
    written = {p: p.stat().st_mtime_ns for p in (tmp_path / "many").glob("results/c*/outcome.json")}
    assert many("identify", found, client, tmp_path / "many", resume=True, **request) == summary
    assert all(p.stat().st_mtime_ns == t for p, t in written.items()) and len(written) == 40


def test_law_a_campaigns_pack_has_every_file_that_it_names(tmp_path):
    (tmp_path / "all/a").mkdir(parents=True)
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared/run.csv").write_text("t_s\n")
    (tmp_path / "shared/terms.toml").write_text('other = "run.csv"\n')
    text = '[aero.x]\nstructure = "../../shared/terms.toml"\n[[run]]\nfile = "../../shared/run.csv"\nnote = "no file"\n'
    (tmp_path / "all/a/campaign.toml").write_text(text)
    packed = Packed(tmp_path / "all/a/campaign.toml", tmp_path / "all")
    assert (packed.root, packed.name) == ("all", "all/a/campaign.toml")
    assert list(packed.files) == ["all/a/campaign.toml", "shared/terms.toml", "shared/run.csv"]


def spoil_build():
    import windfall.distributed as there

    there._build = lambda: "another"


def spoil_disk():
    import tempfile

    tempfile.tempdir = "/no/such/folder"


@pytest.mark.parametrize(("spoil", "words"), [(spoil_build, "another build"), (spoil_disk, "FileNotFoundError")])
def test_law_a_bad_worker_is_retired_and_named(tmp_path, client, spoil, words):
    path = study_file(tmp_path, draws=160, part=8)
    windfall.study(path, tmp_path / "one")
    bad, *_ = client.nthreads()
    client.run(spoil, workers=[bad])
    with pytest.warns(windfall.WindfallWarning, match=f"worker {bad} is retired.*{words}"):
        run(path, client, tmp_path / "many")
    assert files(tmp_path / "many") == files(tmp_path / "one")
    assert bad not in client.nthreads() and client.nthreads()


def test_law_an_error_of_all_workers_is_an_error(tmp_path, client):
    path = study_file(tmp_path, draws=160, part=8)
    client.run(spoil_build)
    with pytest.raises(windfall.StudyError, match="another build"), pytest.warns(windfall.WindfallWarning, match="is retired"):
        run(path, client, tmp_path / "many")
    assert client.nthreads()


def test_law_many_read_where_they_lie_on_a_shared_store(tmp_path, client):
    found = campaigns(tmp_path, 6)
    request = {"method": "equation-error"}
    summary = windfall.many("identify", found, tmp_path / "one", **request)
    os.symlink(found, tmp_path / "mounted")
    bad, *_ = client.nthreads()
    client.run(spoil_build, workers=[bad])
    with pytest.warns(windfall.WindfallWarning, match=f"worker {bad} is retired"):
        assert many("identify", found, client, tmp_path / "many", shared=tmp_path / "mounted", **request) == summary
    assert tree(tmp_path / "many") == tree(tmp_path / "one")


def test_law_a_file_by_an_absolute_path_must_say_the_same_elsewhere(tmp_path):
    path = study_file(tmp_path)
    (tmp_path / "apart").mkdir()
    moved = (tmp_path / "short.toml").rename(tmp_path / "apart/short.toml")
    path.write_text(path.read_text().replace('"short.toml"', f'"{moved}"'))
    packed = Packed(path)
    assert list(packed.files) == ["study.toml"] and list(packed.fixed) == [str(moved)]
    assert windfall._windfall.Study(packed.write(elsewhere := str(tmp_path / "elsewhere"))).parts == 5
    moved.write_text(moved.read_text() + "# changed\n")
    with pytest.raises(windfall.ReadError, match="says something else on"):
        packed.write(elsewhere)
    moved.unlink()
    with pytest.raises(windfall.ReadError, match=r"study.toml: .*short.toml is not on .*; try: its path relative"):
        packed.write(elsewhere)


def test_law_a_bar_counts_parts_and_campaigns(tmp_path, client, capfd):
    pytest.importorskip("tqdm")
    run(study_file(tmp_path, draws=40, part=8), client, tmp_path / "out", progress=True)
    assert "5/5" in capfd.readouterr().err
    many("identify", campaigns(tmp_path, 3), client, tmp_path / "many", progress=True, method="equation-error")
    assert "4/4" in capfd.readouterr().err


def test_law_parts_are_one_table_for_others(tmp_path):
    """Polars reads the folder as it is, Arrow another store; both have every draw, in order, to the bit."""
    fsspec, polars = pytest.importorskip("fsspec"), pytest.importorskip("polars")
    parquet = pytest.importorskip("pyarrow.parquet")
    windfall.study(study_file(tmp_path, draws=40, part=8), tmp_path / "out")
    whole = polars.read_parquet(tmp_path / "out/runs.parquet")
    # Row groups of another size, as a study of many draws has.
    parquet.write_table(parquet.read_table(tmp_path / "out/runs.parquet"), tmp_path / "out/runs.parquet", row_group_size=8)
    names = partition(tmp_path / "out", tmp_path / "parts", rows=20)
    assert [name.rpartition("/")[2] for name in names] == [f"part-{n:06}.parquet" for n in range(3)]
    assert polars.scan_parquet(tmp_path / "parts").collect().equals(whole)
    assert polars.scan_parquet(tmp_path / "parts/*.parquet").collect().equals(whole)
    with pytest.raises(windfall.WriteError, match="is not empty"):
        partition(tmp_path / "out", tmp_path / "parts")
    assert len(partition(tmp_path / "out", tmp_path / "parts", force=True)) == 1
    assert polars.scan_parquet(tmp_path / "parts").collect().equals(whole)
    for address in ("memory://studies/one", f"file://{tmp_path}/apart"):
        partition(tmp_path / "out", address, rows=8)
        store, root = fsspec.core.url_to_fs(address)
        assert len(store.ls(root)) == 5
        assert polars.from_arrow(parquet.read_table(root, filesystem=store)).equals(whole)
