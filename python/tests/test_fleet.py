"""Sixty records of three vehicles on one machine, on workers, on Spark and in shards give the same bytes."""

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
    """Returns the folder of the job and its records, and the result of one machine."""
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
    """Yields a client with two workers, which are spawned processes."""
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
    """Client whose first tasks kill their worker after half of the work."""

    def __init__(self, client, mark):
        self.client, self.mark = client, str(mark)

    def map(self, function, *arguments, **more):
        mark = self.mark

        def task(job, files, out, *more):
            first = function(job, files[: len(files) // 2], out, *more)
            try:
                os.close(os.open(mark, os.O_CREAT | os.O_EXCL))
            except FileExistsError:
                second = function(job, files[len(files) // 2 :], out, *more)
                return tuple(a + b for a, b in zip(first, second))
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


class Counting(Dying):
    """Client that notes every start of a task, and kills its worker on request."""

    def __init__(self, client, notes, kill=False):
        self.client, self.notes, self.kill = client, str(notes), kill

    def map(self, function, *arguments, **more):
        notes, kill = self.notes, self.kill

        def task(*given):
            with open(notes, "a") as file:
                file.write("started\n")
            if kill:
                os._exit(9)
            return function(*given)

        return self.client.map(task, *arguments, **more)

    def starts(self):
        return len(Path(self.notes).read_text().splitlines())


def test_bad_input_is_tried_once(sixty, cluster, tmp_path):
    folder, files, _ = sixty
    text = (folder / "job.toml").read_text()
    (folder / "wrong.toml").write_text(text.replace("{day}", "{tag}"))
    client = Counting(cluster, tmp_path / "starts")
    with pytest.raises(sb.Faults, match="file_name") as raised:
        sb.fleet.run(folder / "wrong.toml", files, tmp_path / "out", client=client)
    # Sixty files are eight tasks. All tasks find the same fault, which is reported once.
    assert client.starts() == 8
    assert len(raised.value.faults) == 1


def test_a_task_that_kills_every_worker_is_an_error(sixty, cluster, tmp_path):
    folder, files, _ = sixty
    client = Counting(cluster, tmp_path / "starts", kill=True)
    with pytest.raises(sb.fleet.FleetError, match="no worker processed"):
        sb.fleet.run(folder / "job.toml", files[:1], tmp_path / "out", client=client)
    # The task of a lost worker is repeated, but not indefinitely.
    assert 1 < client.starts() < 10
    assert not (tmp_path / "out" / "fleet.csv").exists()
    cluster.wait_for_workers(2, timeout=60)


def test_workers_that_do_not_find_the_files_are_an_error(sixty, cluster, tmp_path, monkeypatch):
    folder, files, _ = sixty
    monkeypatch.chdir(folder)
    names = [Path(f).name for f in files[:20]]
    before = cluster.run(os.getcwd)
    cluster.run(os.chdir, "/")
    try:
        with pytest.raises(sb.Faults, match="the worker does not find the file") as raised:
            sb.fleet.run(folder / "job.toml", names, tmp_path / "out", client=cluster)
        assert {f.file for f in raised.value.faults} == set(names)
        assert not (tmp_path / "out" / "fleet.csv").exists()
        # The folder of the results is not that of the caller.
        with pytest.raises(sb.Faults, match="does not find the folder of the caller"):
            sb.fleet.run(folder / "job.toml", files[:20], os.path.relpath(tmp_path / "other"), client=cluster)
        assert not (tmp_path / "other" / "fleet.csv").exists()
        cluster.run(os.chdir, str(folder))
        done = sb.fleet.run(folder / "job.toml", names, tmp_path / "out", client=cluster)
        assert {f.status for f in done.files} == {"done"}
    finally:
        for worker, place in before.items():
            cluster.run(os.chdir, place, workers=[worker])


def test_a_file_that_is_lost_stops_no_other(sixty, cluster, tmp_path):
    folder, files, here = sixty
    for file in [*files, folder / "S.csv", folder / "job.toml"]:
        shutil.copy(file, tmp_path)
    names = [str(tmp_path / Path(f).name) for f in files]
    os.rename(names[7], tmp_path / "away")
    with pytest.raises(sb.Faults) as raised:
        sb.fleet.run(tmp_path / "job.toml", names, tmp_path / "out", client=cluster)
    assert [f.file for f in raised.value.faults] == [names[7]]
    os.rename(tmp_path / "away", names[7])
    client = Counting(cluster, tmp_path / "starts")
    sb.fleet.run(tmp_path / "job.toml", names, tmp_path / "out", client=client)
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here


@pytest.fixture
def store(sixty):
    """Yields an object store of fsspec in memory, with the records."""
    fsspec = needed("fsspec")
    system = fsspec.filesystem("memory")
    for file in sixty[1]:
        system.pipe(f"/bucket/records/{Path(file).name}", Path(file).read_bytes())
    yield system, [f"memory://bucket/records/{Path(f).name}" for f in sixty[1]]
    system.rm("/bucket", recursive=True)


def test_an_object_store_gives_the_same_bytes_and_is_read_once(sixty, store, tmp_path, monkeypatch):
    folder, _, here = sixty
    system, urls = store
    job = folder / "job.toml"
    result = sb.fleet.run(job, urls, tmp_path / "out")
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here
    assert {f.status for f in result.files} == {"done"}
    # No copy remains.
    assert not (tmp_path / "out" / "records").exists()

    copied = []
    get_file = type(system).get_file
    monkeypatch.setattr(type(system), "get_file", lambda self, path, *more, **kw: copied.append(path) or get_file(self, path, *more, **kw))
    again = sb.fleet.run(job, urls, tmp_path / "out")
    assert copied == [] and "60 of 60 files" in again.words
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here
    # Only the object with other bytes is read.
    record(tmp_path / "new.csv", np.random.default_rng(9))
    system.pipe("/bucket/records/T1_05.csv", (tmp_path / "new.csv").read_bytes())
    sb.fleet.run(job, urls, tmp_path / "out")
    assert copied == ["/bucket/records/T1_05.csv"]
    assert (tmp_path / "out" / "fleet.csv").read_bytes() != here


def test_objects_are_read_again_for_another_job_a_few_at_a_time(sixty, store, tmp_path, monkeypatch):
    folder, _, _ = sixty
    _, urls = store
    sb.fleet.run(folder / "job.toml", urls, tmp_path / "out")
    job = sb.Job.read(folder / "job.toml")
    job.measured.noise_microstrain = 0.3
    most = 0
    copies = sb._objects.copies

    def counted(some, out):
        nonlocal most
        most = max(most, len(some))
        return copies(some, out)

    monkeypatch.setattr(sb.fleet, "_copies", counted)
    again = sb.fleet.run(job, urls, tmp_path / "out")
    assert {f.status for f in again.files} == {"done"}
    assert most <= sb.fleet.FILES_A_TASK
    # Digests of the caller do not replace a result that does not exist.
    digests = {u: f.sha256 for u, f in zip(sorted(urls), sorted(again.files, key=lambda f: f.path))}
    other = sb.fleet.run(job, urls, tmp_path / "other", digests=digests)
    assert {f.status for f in other.files} == {"done"}


def test_shards_of_an_object_store_copy_their_part(sixty, store, tmp_path, monkeypatch):
    folder, _, here = sixty
    system, urls = store
    copied = []
    get_file = type(system).get_file
    monkeypatch.setattr(type(system), "get_file", lambda self, path, *more, **kw: copied.append(path) or get_file(self, path, *more, **kw))
    for n in (2, 1):
        sb.fleet.run(folder / "job.toml", urls, tmp_path / "out", shard=f"{n}/2")
    assert len(copied) == len(set(copied)) == 60
    sb.fleet.merge(folder / "job.toml", tmp_path / "out")
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here


def test_wrong_objects_are_reported(sixty, store, tmp_path):
    folder, _, _ = sixty
    system, urls = store
    with pytest.raises(sb.Faults, match="the object does not exist") as raised:
        sb.fleet.run(folder / "job.toml", [urls[0], "memory://bucket/records/T9_01.csv"], tmp_path / "out")
    assert [f.file for f in raised.value.faults] == ["memory://bucket/records/T9_01.csv"]
    with pytest.raises(sb.Faults, match="names no object"):
        sb.fleet.run(folder / "job.toml", ["memory://bucket/../T9_01.csv"], tmp_path / "out")
    system.pipe("/bucket/records/T0_03.csv", b"time,G0\n0.0,1.0\n0.0,")
    result = sb.fleet.run(folder / "job.toml", urls[:4], tmp_path / "out")
    assert [f.status for f in result.files] == ["done", "done", "failed", "done"]
    assert not any("no such file" in f.message for f in result.files)
    assert not (tmp_path / "out" / "records").exists()


def test_workers_read_an_object_store(sixty, cluster, tmp_path):
    needed("fsspec")
    folder, files, here = sixty
    urls = [f"file://{f}" for f in files]
    sb.fleet.run(folder / "job.toml", urls, tmp_path / "out", client=cluster)
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here
    assert not (tmp_path / "out" / "records").exists()


def test_patterns_name_files_and_objects(sixty, cluster, store, tmp_path):
    folder, _, here = sixty
    for out, client in (("here", None), ("spread", cluster)):
        sb.fleet.run(folder / "job.toml", str(folder / "T?_*.csv"), tmp_path / out, client=client)
        assert (tmp_path / out / "fleet.csv").read_bytes() == here
    sb.fleet.run(folder / "job.toml", [f"memory://bucket/**/T{v}_*.csv" for v in range(3)], tmp_path / "store")
    assert (tmp_path / "store" / "fleet.csv").read_bytes() == here
    for nothing in (str(folder / "X*.csv"), "memory://bucket/X*.csv"):
        with pytest.raises(sb.Faults, match="matches the pattern"):
            sb.fleet.run(folder / "job.toml", nothing, tmp_path / "none")
    with pytest.raises(sb.Faults, match="pattern"):
        sb.fleet.run(folder / "job.toml", folder, tmp_path / "none", client=cluster)


def test_vehicle_and_day_may_be_folders_of_a_store(sixty, store, tmp_path):
    folder, files, here = sixty
    system, _ = store
    job = sb.Job.read(folder / "job.toml")
    job.fleet.file_name = "vehicle={vehicle}/day={day}/{any}.csv"
    for file in map(Path, files):
        vehicle, day = file.stem.split("_")
        system.pipe(f"/bucket/lake/vehicle={vehicle}/day={day}/part-0.csv", file.read_bytes())
    sb.fleet.run(job, "memory://bucket/lake/**/*.csv", tmp_path / "out")
    assert (tmp_path / "out" / "fleet.csv").read_bytes() == here


class Leaving:
    """Client that moves the records away when its workers are done."""

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
    # Spark needs two gigabytes of packages and Java, which only `.ci/long` installs.
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
    # A stored result is changed together with its digest. The change appears in the answer, which shows that the record is not read.
    kept = next(p for p in sorted((folder / "again" / "days").glob("*.json")) if json.loads(p.read_text())["path"] == files[0])
    changed = json.loads(kept.read_text())
    changed["done"]["hours"] += 100.0
    del changed["content"]
    body = json.dumps(changed)
    kept.write_text(f'{body[:-1]},"content":"{hashlib.sha256(body.encode()).hexdigest()}"}}')
    result = sb.fleet.run(folder / "job.toml", files, folder / "again")
    assert "60 results stored by an earlier run" in result.notes
    hours = [float(line.split(",")[2]) for line in (folder / "again" / "fleet.csv").read_text().splitlines()[1:]]
    before = [float(line.split(",")[2]) for line in here.decode().splitlines()[1:]]
    assert [round(a - b) for a, b in zip(hours, before)] == [100, 100, 0, 0, 0, 0]
    # A record with other bytes is new, whatever its name.
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
        assert "60 results stored by an earlier run" in result.notes
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
