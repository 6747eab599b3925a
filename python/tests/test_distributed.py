"""A study on a cluster of three worker processes, one of them killed midway, gives the one-machine result byte for byte."""

import os
import signal
import threading
import time

import pytest
import windfall
from test_windfall import files, study_file
from windfall.distributed import _pack, run

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture
def client():
    with (
        distributed.LocalCluster(n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def test_law_a_killed_worker_changes_nothing(tmp_path, client):
    path = study_file(tmp_path, draws=480, part=8)
    windfall.study(path, tmp_path / "one")
    pids = list(client.run(os.getpid).values())
    parts, killed = tmp_path / "many" / "parts", threading.Event()

    def kill():
        while len(list(parts.glob("*.parquet"))) < 5:
            time.sleep(0.002)
        os.kill(pids[0], signal.SIGKILL)
        # Sixty parts in all: when it was killed there was still work.
        if len(list(parts.glob("*.parquet"))) < 50:
            killed.set()

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
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
    moved = tmp_path / "below" / "study.toml"
    moved.write_text(path.read_text().replace("short.toml", "../short.toml"))
    _, packed = _pack(moved)
    assert [name for name, _ in packed] == ["below/study.toml", "short.toml"]
