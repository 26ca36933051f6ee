"""Bugs, threads, forks, Ctrl-C."""

import os
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

#: Many errors of a study.
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
    # Were the lock held, no tick would fall between begin and end.
    assert sum(begin < t < end for t in ticks) >= 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_after_use_works():
    expected = sb.place_rows(S, 6).rows.tolist()
    child = os.fork()
    if child == 0:
        # Whatever happens, the child must not go on with the tests.
        code = 1
        try:
            code = 0 if sb.place_rows(S, 6).rows.tolist() == expected else 1
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
def test_ctrl_c_stops_the_work():
    # A shell's background job ignores Ctrl-C, and so would this process.
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

    # Ten thousand calls in all. A result has 2.5 kB or more: kept, they would be 8 MB and more.
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
    # Loads twice (blocks, then all), 64 MB, and little else; the record has 480 MB.
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
    # The solution of the first is taken, which is a note.
    assert len(out.notes) == 1
    assert [r.getMessage() for r in caplog.records] == [f"place: {note}" for note in out.notes]


def test_a_long_stage_is_left_between_two_of_its_parts(strip_folder):
    job = sb.Job.read("job.toml")
    job.gauge = [{"name": f"{e}", "element": e, "surface": "top", "direction": [1, 0, 0]} for e in (2, 4, 7, 9)]
    # 400 errors of a second and more each, one stage.
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
    # The engine with its stubs, and the package with the types that its sources state.
    allowed = Path(__file__).parent / "stubtest.txt"
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "strainbridge", "--ignore-disjoint-bases", "--allowlist", str(allowed)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
