"""Bugs, threads, forks, Ctrl-C."""

import os
import pickle
import re
import runpy
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, needed

import strainbridge as sb
from strainbridge import _strainbridge as engine

S = np.random.default_rng(0).normal(size=(60, 4))

#: Many errors for a study.
ERRORS = [{"kind": "relative-uniform", "size": 0.001 * (1 + i)} for i in range(400)]


def test_a_bug_is_an_exception_and_the_next_call_works():
    for threads in (None, 1):
        with pytest.raises(RuntimeError, match="asked to fail"):
            engine._fail(threads)
    assert len(sb.place_rows(S, 6).rows) == 6


def test_threads_at_once_give_the_same_answers():
    expected = [sb.place_rows(S, n).rows.tolist() for n in range(5, 13)]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda n: sb.place_rows(S, n).rows.tolist(), range(5, 13)))
    assert found == expected


def test_other_threads_run_meanwhile():
    ticks = []
    strain = np.random.default_rng(1).normal(size=(400_000, 60))

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.002)

    done = threading.Event()
    thread = threading.Thread(target=tick)
    thread.start()
    try:
        begin = time.perf_counter()
        sb.recover_rows(S, strain, threads=1)
        end = time.perf_counter()
    finally:
        done.set()
        thread.join()
    # If the call held the interpreter lock, there would be no tick between begin and end.
    assert sum(begin < t < end for t in ticks) >= 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_after_use_works():
    expected = sb.place_rows(S, 6).rows.tolist()
    child = os.fork()
    if child == 0:
        # In any case, the child process must not continue with the tests.
        code = 1
        try:
            code = 0 if sb.place_rows(S, 6).rows.tolist() == expected else 1
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
def test_ctrl_c_stops_the_work():
    # A background job of a shell ignores Ctrl-C, and this process would inherit that.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    job = sb.Job.read(ROOT / "models" / "truck-shell" / "job.toml")
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            sb.place(job, cache=False)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert len(sb.place_rows(S, 6).rows) == 6


def test_progress_is_told():
    heard = []
    out = sb.place(ROOT / "models" / "truck-shell" / "job.toml", cache=False, progress=lambda *said: heard.append(said))
    assert len({stage for stage, _, _ in heard}) >= 2 and len(out.gauges) > 0
    assert all(isinstance(stage, str) and done >= 0 and total >= 0 for stage, done, total in heard)


def test_what_the_one_who_hears_raises_comes_out():
    def stop(*_):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        sb.place(ROOT / "models" / "truck-shell" / "job.toml", cache=False, progress=stop)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_many_calls_leak_nothing():
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    # Ten thousand calls in total. A result has 2.5 kB or more, so a leak would be 8 MB or more.
    signal_of_2000 = np.random.default_rng(1).normal(size=2000)
    many, strain = np.random.default_rng(2).normal(size=(60, 10)), np.random.default_rng(2).normal(size=(20, 60))
    table = {"a": np.zeros(1000)}
    for ask in (
        lambda: sb.rainflow(signal_of_2000),
        lambda: sb.recover_rows(many, strain, threads=1),
        lambda: sb.Table.from_columns(table).__arrow_c_stream__(),
    ):
        for _ in range(300):
            ask()
        before = resident()
        for _ in range(3_400):
            ask()
        assert resident() - before < 4e6


def test_a_long_record_is_not_copied():
    resource = pytest.importorskip("resource")
    strain = np.random.default_rng(2).normal(size=(1_000_000, 60))
    sb.recover_rows(S, strain[:3000])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    out = sb.recover_rows(S, strain)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    scale = 1024 if sys.platform != "darwin" else 1
    # Loads twice (blocks, then all), 64 MB, and little more. The record has 480 MB.
    assert (after - before) * scale < 0.5 * strain.nbytes
    assert out.loads.shape == (1_000_000, 4)


def test_a_bar_is_drawn_where_tqdm_is_installed(monkeypatch):
    drawn = needed("tqdm.auto")
    bars = []

    class Bar(drawn.tqdm):
        def __init__(self, *args, **more):
            super().__init__(*args, **{**more, "disable": False, "file": open(os.devnull, "w")})
            bars.append(self)

        def refresh(self, *args, **more):
            seen.append((self.desc, self.n, self.total))
            if len({desc for desc, _, _ in seen}) == 2:
                raise LookupError("enough")

    seen = []
    monkeypatch.setattr(drawn, "tqdm", Bar)
    with pytest.raises(LookupError, match="enough"):
        sb.place(ROOT / "models" / "truck-shell" / "job.toml", cache=False, progress=True)
    assert len(bars) == 1
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(ImportError, match="tqdm"):
        sb.check(ROOT / "models" / "truck-shell" / "job.toml", progress=True)


def test_notes_go_to_the_log(caplog, strip_folder, monkeypatch):
    monkeypatch.setenv("STRAINBRIDGE_CACHE", str(strip_folder / "kept"))
    sb.place("job.toml")
    with caplog.at_level("DEBUG", logger="strainbridge"):
        out = sb.place("job.toml")
    # The stored solution of the first call is used. A note reports it, and another note reports that the mesh error is
    # not computed.
    assert "a stored solution is used" in out.notes[0]
    assert [r.getMessage() for r in caplog.records] == [f"place: {note}" for note in out.notes]


def test_a_long_stage_is_left_between_two_of_its_parts(strip_folder):
    job = sb.Job.read("job.toml")
    job.gauge = [{"name": f"{e}", "element": e, "surface": "top", "direction": [1, 0, 0]} for e in (2, 4, 7, 9)]
    # 400 errors that each take a second or more, in one stage.
    job.study = {"layouts": ["given"], "gauges": [4], "errors": ERRORS, "trials": 1_000_000, "seed": 1}
    told = []

    def stop(stage, done, total):
        told.append((stage, total))
        if stage == "repeat":
            raise KeyboardInterrupt

    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        sb.study(job, cache=False, progress=stop)
    assert told[-1] == ("repeat", len(ERRORS))
    assert time.perf_counter() - begin < 30.0


def test_work_stops_between_two_cases():
    begun = []

    def stop(stage, done, total):
        begun.append(stage)
        if len(set(begun)) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sb.place(ROOT / "models" / "truck-shell" / "job.toml", cache=False, progress=stop)
    assert len(sb.place_rows(S, 6).rows) == 6


def test_stubs_and_types_fit_the_package(tmp_path):
    needed("mypy")
    # Compares the engine with its stubs, and the package with the types in its sources.
    allowed = Path(__file__).parent / "stubtest.txt"
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "strainbridge", "--ignore-disjoint-bases", "--allowlist", str(allowed)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_misspelt_key_is_found_by_a_type_checker(tmp_path):
    needed("mypy")
    page = (ROOT / "docs" / "python" / "place.md").read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL))
    wrong = code.replace("job.placement.spacing", "job.placement.spacin") + '\njob.load[0].nam = "LF"\njob.plcement.gauges = 3\nsb.place(job, thread=2)\n'
    for name, text in (("right.py", code), ("wrong.py", wrong)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    scripts = [ROOT / "examples" / "cluster" / "shard.py", ROOT / "examples" / "cluster" / "dask_ssh.py"]
    call = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--allow-untyped-calls", "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run([*call, "right.py", "wrong.py", *map(str, scripts)], cwd=tmp_path, capture_output=True, text=True)
    errors = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert all(e.startswith("wrong.py:") for e in errors), done.stdout
    for key in ("spacin", "nam", "plcement", "thread"):
        assert sum(f'"{key}"' in e for e in errors) == 1, done.stdout
    assert len(errors) == 4


def test_the_typed_keys_are_made_from_the_schema():
    made = runpy.run_path(str(ROOT / "python" / "keys.py"))["text"]()
    kept = (ROOT / "python" / "strainbridge" / "_keys.py").read_text(encoding="utf-8")
    assert made == kept, "python -P python/keys.py > python/strainbridge/_keys.py"


def test_faults_use_words_of_python(matrix_folder):
    from strainbridge._words import in_python

    assert in_python("state it: [measured] time_unit = \"ms\"") == 'state it: job.measured.time_unit = "ms"'
    assert in_python("write a [[correction]] with sign = -1") == "write a job.correction with sign = -1"
    assert in_python("the header, such as `time [ms]` or `G1 [um/m]`") == "the header, such as `time [ms]` or `G1 [um/m]`"
    assert in_python("choose another folder with `--out`, or move the file away") == "choose another folder, or move the file away"
    S = np.random.default_rng(1).normal(size=(50, 3))
    with pytest.raises(sb.Faults) as many:
        sb.place_rows(S, 60)
    with pytest.raises(sb.Faults) as few:
        sb.place_rows(S, 2)
    (matrix_folder / "taken").mkdir()
    (matrix_folder / "taken" / "loads.csv").write_text("mine\n")
    with pytest.raises(sb.Faults) as taken:
        sb.recover("job.toml").save("taken")
    with pytest.raises(sb.Faults) as nothing:
        sb.fleet.merge("job.toml", matrix_folder / "taken")
    for raised in (many, few, taken, nothing):
        for words in ("--", "[", "candidates"):
            assert words not in str(raised.value)
        assert pickle.loads(pickle.dumps(raised.value)).faults == raised.value.faults


def test_truths_are_no_counts_and_check_needs_a_file():
    for call in (lambda: sb.place_rows(S, True), lambda: sb.relax(S, True), lambda: sb.place_rows(S, 6, threads=True)):
        with pytest.raises(TypeError, match="True"):
            call()
    with pytest.raises(sb.Faults, match="no file is given"):
        sb.check()


def test_arrays_of_a_mesh_may_be_changed(strip_folder):
    for mesh in (sb.Deck.read("strip.bdf").mesh(), sb.place("job.toml").mesh()):
        arrays = [mesh.points, mesh.cells, mesh.celltypes, *mesh.point_data.values(), *mesh.cell_data.values()]
        assert arrays and all(a.flags.writeable for a in arrays)
        mesh.points[:] *= 2.0


def test_a_fleet_by_the_command_is_an_outcome(matrix_folder, command, monkeypatch):
    here = sb.fleet.run("job.toml", ["T1_1.csv", "T2_1.csv"], "here")
    found = os.environ.get("STRAINBRIDGE_COMMAND") or str(ROOT / "target" / "debug" / "strainbridge")
    monkeypatch.setenv("STRAINBRIDGE", found)
    there = sb.fleet.run("job.toml", ["T1_1.csv", "T2_1.csv"], "there")
    assert isinstance(there, sb.Outcome)
    assert [v.name for v in there.vehicles] == [v.name for v in here.vehicles] == ["T1", "T2"]
    assert there.to_arrow("fleet").num_rows == here.to_arrow("fleet").num_rows == 4
    monkeypatch.delenv("STRAINBRIDGE")
    assert (matrix_folder / "here" / "fleet.csv").read_bytes() == (matrix_folder / "there" / "fleet.csv").read_bytes()
