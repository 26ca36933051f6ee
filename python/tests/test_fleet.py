"""Sixty records of three vehicles on one machine, on workers, on Spark and in shards: the same bytes."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import MATRIX, MATRIX_TEXT, ROOT, needed

import strainbridge as sb

NAMES = ",".join(f"G{g} [um/m]" for g in range(len(MATRIX)))


def record(path, rng, samples=400, keep=slice(None)):
    waves = np.cumsum(rng.normal(0.0, 1.0, (samples, 2)), axis=0)
    readings = (waves - waves.mean(axis=0)) @ MATRIX.T
    names = ",".join(NAMES.split(",")[keep])
    lines = [f"{i * 0.01:.2f}," + ",".join(f"{v:.6f}" for v in row[keep]) for i, row in enumerate(readings)]
    path.write_text("\n".join([f"time,{names}", *lines, ""]))


@pytest.fixture(scope="module")
def sixty(tmp_path_factory):
    """The folder of the job and its records, and what one machine makes of them."""
    folder = tmp_path_factory.mktemp("fleet")
    rng = np.random.default_rng(60)
    rows = [f"G{g},{a},{b}" for g, (a, b) in enumerate(MATRIX)]
    (folder / "S.csv").write_text("\n".join(["gauge,A.FZ,B.FZ", *rows, ""]))
    (folder / "job.toml").write_text(MATRIX_TEXT.replace('strain = "strain.csv"\n', ""))
    files = [folder / f"T{v}_{d:02}.csv" for v in range(3) for d in range(1, 21)]
    for file in files:
        record(file, rng)
    files = [str(f) for f in files]
    sb.fleet.run(folder / "job.toml", files, folder / "here")
    return folder, files, (folder / "here" / "fleet.csv").read_bytes()


@pytest.fixture(scope="module")
def cluster():
    """Two workers, processes that were spawned."""
    distributed = needed("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as made:
        with distributed.Client(made) as client:
            yield client


def test_one_machine_has_a_row_a_vehicle_and_load(sixty):
    lines = sixty[2].decode().splitlines()
    assert lines[0] == "vehicle,files,hours,load,max,min,damage,damage_low,damage_high"
    assert [line.split(",")[:2] for line in lines[1:]] == [[f"T{v}", "20"] for v in (0, 0, 1, 1, 2, 2)]


def test_two_workers_write_the_same_bytes(sixty, cluster):
    folder, files, here = sixty
    sb.fleet.run(sb.Job.read(folder / "job.toml"), files, folder / "spread", client=cluster)
    assert (folder / "spread" / "fleet.csv").read_bytes() == here


class Dying:
    """A client whose first tasks kill their worker: after the work is half done."""

    def __init__(self, client, mark):
        self.client, self.mark = client, str(mark)

    def map(self, function, *arguments, **more):
        mark = self.mark

        def task(job, files, out, threads):
            done = function(job, files[: len(files) // 2], out, threads)
            try:
                os.close(os.open(mark, os.O_CREAT | os.O_EXCL))
            except FileExistsError:
                return done + function(job, files[len(files) // 2 :], out, threads)
            os._exit(9)

        return self.client.map(task, *arguments, **more)

    def gather(self, futures, errors):
        return self.client.gather(futures, errors=errors)


def test_a_worker_that_dies_half_way_costs_nothing(sixty, cluster):
    folder, files, here = sixty
    mark = folder / "died"
    result = sb.fleet.run(folder / "job.toml", files, folder / "killed", client=Dying(cluster, mark))
    assert mark.exists()
    assert (folder / "killed" / "fleet.csv").read_bytes() == here
    assert {f.status for f in result.files} == {"done"}


class Leaving:
    """A client that takes the records away when its workers are done."""

    def __init__(self, client, files):
        self.client, self.files = client, files

    def map(self, *arguments, **more):
        return self.client.map(*arguments, **more)

    def gather(self, futures, errors):
        done = self.client.gather(futures, errors=errors)
        for file in self.files:
            os.remove(file)
        return done


def test_the_caller_reads_no_record_that_a_worker_did(sixty, cluster, tmp_path):
    folder, files, _ = sixty
    some = [shutil.copy(f, tmp_path) for f in files[::7]]
    here = sb.fleet.run(folder / "job.toml", some, tmp_path / "here")
    spread = sb.fleet.run(folder / "job.toml", some, tmp_path / "spread", client=Leaving(cluster, some))
    assert not any(map(os.path.exists, some))
    assert {f.status for f in spread.files} == {"done"} == {f.status for f in here.files}
    assert (tmp_path / "spread" / "fleet.csv").read_bytes() == (tmp_path / "here" / "fleet.csv").read_bytes()


def test_four_shards_in_any_order_write_the_same_bytes(sixty):
    folder, files, here = sixty
    counts = [len(sb.fleet.run(folder / "job.toml", files[::-1], folder / "shards", shard=f"{n}/4").files) for n in (3, 1, 4, 2)]
    assert counts == [15] * 4
    merged = sb.fleet.merge(folder / "job.toml", folder / "shards")
    assert len(merged.files) == 60
    assert (folder / "shards" / "fleet.csv").read_bytes() == here
    with pytest.raises(sb.Faults, match="shard|part"):
        sb.fleet.run(folder / "job.toml", files, folder / "shards", shard="5/4")


def test_spark_writes_the_same_bytes(sixty):
    folder, files, here = sixty
    # Two gigabytes of packages and a Java: `.ci/long` has them.
    pytest.importorskip("pyspark")
    if shutil.which("java") is None:
        pytest.skip("no Java")
    env = {**os.environ, "PYSPARK_PYTHON": sys.executable, "SPARK_LOCAL_IP": "127.0.0.1"}
    call = [sys.executable, str(ROOT / "examples" / "spark_fleet.py"), str(folder / "job.toml"), str(folder / "spark"), *files]
    done = subprocess.run(call, cwd=folder, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "'done': 60" in done.stdout
    assert (folder / "spark" / "fleet.csv").read_bytes() == here


def test_a_second_run_decodes_nothing(sixty):
    folder, files, here = sixty
    shutil.copytree(folder / "here", folder / "again")
    # A kept result that is changed, its digest too, shows in the answer: it is what was read, not the record.
    kept = next(p for p in sorted((folder / "again" / "days").glob("*.json")) if json.loads(p.read_text())["path"] == files[0])
    changed = json.loads(kept.read_text())
    changed["done"]["hours"] += 100.0
    del changed["content"]
    body = json.dumps(changed)
    kept.write_text(f'{body[:-1]},"content":"{hashlib.sha256(body.encode()).hexdigest()}"}}')
    result = sb.fleet.run(folder / "job.toml", files, folder / "again")
    assert "60 results kept from an earlier run" in result.notes
    hours = [float(line.split(",")[2]) for line in (folder / "again" / "fleet.csv").read_text().splitlines()[1:]]
    before = [float(line.split(",")[2]) for line in here.decode().splitlines()[1:]]
    assert [round(a - b) for a, b in zip(hours, before)] == [100, 100, 0, 0, 0, 0]
    # A record of other bytes is new, whatever its name.
    record(Path(files[0]).with_name("T0_21.csv"), np.random.default_rng(1))
    more = sb.fleet.run(folder / "job.toml", [*files, str(folder / "T0_21.csv")], folder / "again")
    assert more.vehicles[0].files == 21


def test_what_damage_is_held_against_redoes_no_record(sixty, cluster, tmp_path):
    folder, files, here = sixty
    shutil.copytree(folder / "here", tmp_path / "kept")
    job = sb.Job.read(folder / "job.toml")
    job.fleet.reference = {"vehicle": "T0", "day": "01"}
    sb.fleet.run(job, files, tmp_path / "fresh")
    for client in (None, cluster):
        result = sb.fleet.run(job, files, tmp_path / "kept", client=client)
        assert "60 results kept from an earlier run" in result.notes
        assert len(list((tmp_path / "kept" / "days").glob("*.json"))) == 60
        assert (tmp_path / "kept" / "fleet.csv").read_bytes() == here
        relative = [(tmp_path / out / "fleet_relative.csv").read_bytes() for out in ("kept", "fresh")]
        assert relative[0] == relative[1]


def test_what_is_broken_is_reported_on_workers_too(sixty, cluster, tmp_path):
    folder, files, _ = sixty
    for file in [*files, folder / "S.csv", folder / "job.toml"]:
        shutil.copy(file, tmp_path)
    names = [str(tmp_path / Path(f).name) for f in files]
    cut, lacking = Path(names[3]), Path(names[25])
    text = cut.read_text()
    cut.write_text(text[: text.rindex("\n", 0, len(text) // 2) + 9])
    record(lacking, np.random.default_rng(2), keep=slice(0, 4))
    shutil.copy(names[45], tmp_path / "T2_06b.csv")
    names.append(str(tmp_path / "T2_06b.csv"))
    spread = sb.fleet.run(tmp_path / "job.toml", names, tmp_path / "spread", client=cluster)
    status = {Path(f.path).name: f.status for f in spread.files}
    assert status.pop(cut.name) == "failed" and status.pop("T2_06b.csv") == "copy"
    assert set(status.values()) == {"done"} and len(status) == 59
    assert any(f.code == "gauge-without-strain" and "G4" in f.subject for f in spread.findings)
    assert not spread.is_reliable
    assert [v.files for v in spread.vehicles] == [19, 20, 20]
    here = sb.fleet.run(tmp_path / "job.toml", names, tmp_path / "here")
    assert here.vehicles == spread.vehicles
    assert (tmp_path / "here" / "fleet.csv").read_bytes() == (tmp_path / "spread" / "fleet.csv").read_bytes()


def test_bad_input_is_one_exception_wherever_it_is_done(sixty, cluster):
    folder, files, _ = sixty
    text = (folder / "job.toml").read_text()
    (folder / "bad.toml").write_text(text.replace("{day}", "{tag}"))
    for client in (None, cluster):
        with pytest.raises(sb.Faults, match="file_name"):
            sb.fleet.run(folder / "bad.toml", files, folder / "bad", client=client)
