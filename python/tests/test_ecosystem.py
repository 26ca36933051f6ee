"""Arguments and outcomes as users of numpy, pandas and pickle expect them."""

import copy
import pickle
import warnings
from array import array
from collections import deque
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal
from fractions import Fraction
from multiprocessing import get_context

import numpy as np
import pytest
from conftest import MATRIX, STRIP_JOB, needed, strip

import strainbridge as sb

RNG = np.random.default_rng(2)
S = np.round(RNG.normal(size=(12, 3)) * 64.0)
STRAIN = np.round(RNG.normal(0.0, 5.0, (7, 3)) @ S.T)


def kinds(a):
    """Returns the same numbers in other arrays and tables."""
    wide = np.zeros((2 * len(a), 2 * a.shape[1]))
    wide[::2, ::2] = a
    big = np.vstack([a[:1], a, a[:1]])
    readonly = a.copy()
    readonly.flags.writeable = False
    out = {
        "float64": a,
        "float32": a.astype(np.float32),
        "int64": a.astype(np.int64),
        "int32": a.astype(np.int32),
        "int16": a.astype(np.int16),
        "big-endian": a.astype(">f8"),
        "long double": a.astype(np.longdouble),
        "Fortran order": np.asfortranarray(a),
        "transpose": a.T.copy().T,
        "every second row and column": wide[::2, ::2],
        "rows of a larger array": big[1:-1],
        "reversed twice": a[::-1][::-1],
        "read only": readonly,
        "lists": a.tolist(),
        "tuples": tuple(map(tuple, a)),
        "list of arrays": list(a),
        "objects": a.astype(object),
        "masked, nothing masked": np.ma.array(a),
        "memoryview": memoryview(np.ascontiguousarray(a)),
        "through __array__": Wrapped(a),
        "whole numbers, big-endian": a.astype(">i4"),
        "matrix": a.view(np.matrix),
        "unaligned": unaligned(a),
        "arrays of the standard library": [array("d", row) for row in a],
        "deque of rows": deque(a),
        "decimal numbers": [[Decimal(int(v)) for v in row] for row in a],
        "fractions": [[Fraction(int(v), 1) for v in row] for row in a],
        "scalars of numpy": [[np.float64(v) for v in row] for row in a],
    }
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(a)
    out["pandas"] = frame
    out["pandas values"] = frame.values
    out["pandas float32"] = frame.astype("float32")
    out["pandas nullable"] = frame.astype("Float64")
    out["pandas nullable whole"] = frame.astype("Int64")
    out["pandas with index"] = frame.set_index(pandas.Index([f"R{i}" for i in range(len(a))], name="run"))
    out["pandas mixed types"] = frame.astype({0: "int64"})
    out["pandas of objects"] = frame.astype(object)
    out["pandas of Arrow"] = frame.astype("double[pyarrow]")
    polars = pytest.importorskip("polars")
    out["polars"] = polars.DataFrame(a)
    out["polars to_numpy"] = polars.DataFrame(a).to_numpy()
    out["polars float32"] = polars.DataFrame(a.astype(np.float32))
    out["polars whole numbers"] = polars.DataFrame(a.astype(np.int64))
    pyarrow = pytest.importorskip("pyarrow")
    out["pyarrow table"] = pyarrow.table({str(i): c for i, c in enumerate(a.T)})
    out["dask"] = pytest.importorskip("dask.array").from_array(a, chunks=(5, 2))
    out["pyarrow columns"] = np.column_stack([pyarrow.array(c) for c in a.T])
    return out


def unaligned(a):
    """Returns the numbers at addresses that are no multiple of eight."""
    room = np.zeros(len(a), dtype=[("flag", "i1"), ("numbers", "f8", (a.shape[1],))])
    room["numbers"] = a
    assert not room["numbers"].flags.aligned
    return room["numbers"]


def test_the_table_of_kinds_is_long():
    assert len(kinds(S)) >= 40


class Wrapped:
    def __init__(self, a):
        self._a = a

    def __array__(self, dtype=None, copy=None):
        return self._a


@pytest.mark.parametrize("name", kinds(S))
def test_any_array_of_numbers_is_taken(name):
    expected = sb.recover_rows(S, STRAIN)
    out = sb.recover_rows(kinds(S)[name], kinds(STRAIN)[name])
    np.testing.assert_array_equal(out.loads, expected.loads)
    assert sb.place_rows(kinds(S)[name], 5).rows.tolist() == sb.place_rows(S, 5).rows.tolist()


def test_columns_of_any_layout_are_counted():
    expected = sb.rainflow(STRAIN[:, 0].copy())
    for signal in (STRAIN[:, 0], STRAIN[:, 0].astype(np.float32), list(STRAIN[:, 0]), sb.recover_rows(S, STRAIN).loads[:, 0] * 0 + STRAIN[:, 0]):
        np.testing.assert_array_equal(sb.rainflow(signal), expected)


def test_masked_and_missing_readings_are_missing():
    holes = STRAIN.copy()
    holes[2, 4] = np.nan
    expected = sb.recover_rows(S, holes)
    mask = np.isnan(holes)
    masked = np.ma.array(np.where(mask, 9999.0, STRAIN), mask=mask)
    np.testing.assert_array_equal(sb.recover_rows(S, masked).loads, expected.loads)
    pandas = needed("pandas")
    frame = pandas.DataFrame(holes).astype("Float64")
    assert frame.isna().to_numpy().sum() == 1
    np.testing.assert_array_equal(sb.recover_rows(S, frame).loads, expected.loads)
    with pytest.raises(sb.Faults, match="finite"):
        sb.recover_rows(np.ma.array(S, mask=S == S[0, 0]), STRAIN)


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: sb.place_rows(S, 8.7), TypeError, "n is 8.7"),
        (lambda: sb.place_rows(S, "8"), TypeError, "n is '8'"),
        (lambda: sb.recover_rows(S, STRAIN, noise="1"), TypeError, "noise"),
        (lambda: sb.recover_rows(S, STRAIN, noise=np.ones(11)), ValueError, "noise"),
        (lambda: sb.recover_rows(S, STRAIN, noise=np.zeros(12)), ValueError, "noise"),
        (lambda: sb.recover_rows(S.astype(str), STRAIN), TypeError, "S has the type"),
        (lambda: sb.recover_rows(S * 1j, STRAIN), TypeError, "S has the type complex128"),
        (lambda: sb.recover_rows([[object()]], STRAIN), TypeError, "S contains"),
        (lambda: sb.place_rows(S, 5, threads=0), ValueError, "threads is 0"),
        (lambda: sb.place_rows(S, 5, threads=10**9), ValueError, "threads is 1000000000"),
        (lambda: sb.place_rows(S, 10**30), ValueError, "at most"),
        (lambda: sb.place_rows(S, 5, threads=1.5), TypeError, "threads is 1.5"),
        (lambda: sb.check(), sb.Faults, "no file"),
        (lambda: sb.fleet.run("job.toml", "none.csv"), sb.Faults, "none.csv"),
    ],
)
def test_arguments_of_another_type_are_refused(call, error, said):
    with pytest.raises(error, match=said):
        call()


def test_all_cores_may_be_asked_for_as_elsewhere():
    assert sb.place_rows(S, 5, threads=-1).rows.tolist() == sb.place_rows(S, 5).rows.tolist()


@pytest.mark.parametrize("power", [-1000, 1000])
def test_the_scale_of_s_changes_the_determinant_by_what_it_must(power):
    plan, scaled = sb.place_rows(S, 5), sb.place_rows(np.ldexp(S, power), 5)
    assert scaled.rows.tolist() == plan.rows.tolist()
    # det(S'S) of three loads is multiplied by the scale to the sixth power.
    grown = 6 * power * np.log(2.0)
    assert scaled.log_det == pytest.approx(plan.log_det + grown, abs=1e-9)
    assert scaled.efficiency_bound == pytest.approx(plan.efficiency_bound, abs=1e-9)
    assert sb.relax(np.ldexp(S, power), 5).upper_bound == pytest.approx(sb.relax(S, 5).upper_bound + grown, abs=1e-9)


def test_noise_by_gauge_gives_weighted_least_squares():
    sd = RNG.uniform(0.5, 4.0, len(S))
    strain = RNG.normal(0.0, 5.0, (30, 3)) @ S.T + RNG.normal(0.0, sd, (30, len(S)))
    out = sb.recover_rows(S, strain, noise=sd)
    w = S / sd[:, None]
    np.testing.assert_allclose(out.loads, np.linalg.lstsq(w, (strain / sd).T, rcond=None)[0].T, rtol=1e-9, atol=1e-12)
    covariance = np.linalg.inv(w.T @ w)
    np.testing.assert_allclose(out.covariance, covariance, rtol=1e-9)
    np.testing.assert_allclose(out.sigma, np.broadcast_to(np.sqrt(np.diag(covariance)), (30, 3)), rtol=1e-9)
    residuals = strain - out.loads @ S.T
    np.testing.assert_array_equal(out.residuals, residuals)
    np.testing.assert_allclose(out.chi2, ((residuals / sd) ** 2).sum(axis=1))
    assert out.is_reliable


def test_one_run_is_a_vector():
    one, all_runs = sb.recover_rows(S, STRAIN[3]), sb.recover_rows(S, STRAIN[3:4])
    assert one.loads.shape == (3,)
    for name in ("loads", "low", "high", "sigma", "residuals"):
        np.testing.assert_array_equal(getattr(one, name), getattr(all_runs, name)[0])
    assert one.chi2 == all_runs.chi2[0]
    assert one.to_arrow().num_rows == 1


def test_an_unreliable_answer_warns_once_and_raises_if_asked(matrix_folder):
    (matrix_folder / "S.csv").write_text("gauge,A.FZ,B.FZ\n" + "".join(f"G{g},{a},{a}\n" for g, (a, _) in enumerate(MATRIX)))
    with pytest.warns(sb.UnreliableWarning) as caught:
        out = sb.sensitivity("job.toml")
    assert len(caught) == 1 and caught[0].filename == __file__
    with pytest.raises(sb.UnreliableWarning):
        out.raise_if_unreliable()
    rows = np.random.default_rng(4).normal(size=(8, 2)) * 10.0
    with pytest.warns(sb.UnreliableWarning):
        bad = sb.recover_rows(rows, np.random.default_rng(5).normal(0.0, 500.0, (40, 8)))
    with pytest.raises(sb.UnreliableWarning):
        bad.raise_if_unreliable()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        good = sb.recover_rows(S, STRAIN)
    assert good.raise_if_unreliable() is good


def test_s_is_at_hand(matrix_folder):
    out = sb.sensitivity("job.toml")
    # The table is in microstrain per kN, and the job's unit of force is N. A product and a quotient cause rounding.
    np.testing.assert_allclose(out.S, MATRIX / 1000.0, rtol=4e-16)
    assert out.gauges == [f"G{g}" for g in range(5)] and out.loads == ["A.FZ", "B.FZ"]
    table = out.to_arrow()
    assert table.column_names == ["gauge", "A.FZ", "B.FZ"] and table.num_rows == 5
    with pytest.raises(AttributeError, match="sensitivity"):
        sb.recover("job.toml").S
    loads = sb.recover_rows(out.S, np.loadtxt("strain.csv", delimiter=",", skiprows=1, usecols=range(1, 6))).loads
    of_job = np.array([load.value for load in sb.recover("job.toml").loads]).reshape(6, 2)
    np.testing.assert_allclose(loads / 1000.0, of_job, rtol=1e-9)


def recovered(job):
    return sb.recover(job)


def test_outcomes_are_copied_pickled_and_come_from_other_processes(matrix_folder, tmp_path):
    out = sb.recover("job.toml")
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        far = pool.submit(recovered, sb.Job.read("job.toml")).result()
    for other in (pickle.loads(pickle.dumps(out)), copy.copy(out), copy.deepcopy(out), far, pickle.loads(pickle.dumps(far))):
        assert other == out and repr(other) == repr(out) and other._repr_html_() == out._repr_html_()
        assert other.loads[0].value == out.loads[0].value
        other.save(tmp_path / "other")
        out.save(tmp_path / "own")
        assert (tmp_path / "other" / "loads.csv").read_bytes() == (tmp_path / "own" / "loads.csv").read_bytes()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "loads.csv").write_text("mine")
    with pytest.raises(sb.Faults, match="loads.csv"):
        far.save(tmp_path / "mine")
    assert (tmp_path / "mine" / "loads.csv").read_text() == "mine" and len(list((tmp_path / "mine").iterdir())) == 1
    sensitivity = pickle.loads(pickle.dumps(sb.sensitivity("job.toml")))
    np.testing.assert_allclose(sensitivity.S, MATRIX / 1000.0, rtol=4e-16)
    table = pickle.loads(pickle.dumps(out.to_arrow()))
    assert table.column_names == out.to_arrow().column_names and table.num_rows == len(out.loads)
    assert (sb.recover("job.toml") == out) and not (sb.sensitivity("job.toml") == out)


def test_decks_are_pickled(strip_folder):
    deck = sb.Deck.read("strip.bdf")
    deck.cards("GRID")["x"][0, 0] = -1.0
    again = pickle.loads(pickle.dumps(deck))
    assert again.cards("GRID")["x"][0, 0] == -1.0 and again.counts == deck.counts


def test_columns_of_tables_are_in_the_order_of_the_result(matrix_folder):
    out = sb.recover("job.toml")
    assert out.to_arrow().column_names[:4] == list(out.to_dict()["loads"][0])[:4]
    assert out.to_arrow().column_names[:2] == ["run", "name"]


def test_a_job_takes_tables(matrix_folder):
    pandas, polars, pyarrow = needed("pandas"), needed("polars"), needed("pyarrow")
    frame = pandas.read_csv("strain.csv").set_index("run")
    expected = sb.recover("job.toml").loads
    for table in (frame, frame.reset_index(), polars.from_pandas(frame.reset_index()), pyarrow.Table.from_pandas(frame.reset_index(), preserve_index=False)):
        job = sb.Job.read("job.toml")
        job.measured.strain = table
        job.sensitivity.file = pandas.read_csv("S.csv")
        assert [load.value for load in sb.recover(job).loads] == [load.value for load in expected]
        keys = sb.Job.read("job.toml").to_dict()
        keys["measured"]["strain"] = table
        assert [load.value for load in sb.recover(keys).loads] == [load.value for load in expected]
    assert [load.value for load in sb.recover(pickle.loads(pickle.dumps(job))).loads] == [load.value for load in expected]
    record = pandas.read_csv("T1_1.csv")
    record.index = pandas.TimedeltaIndex(pandas.to_timedelta(record.pop("time"), unit="s"), name="time")
    job.measured.strain = record
    by_file = sb.Job.read("job.toml")
    by_file.measured.strain = "T1_1.csv"
    np.testing.assert_allclose(sb.recover(job).history()["A.FZ"], sb.recover(by_file).history()["A.FZ"], rtol=1e-12)


def test_sections_are_typed(strip_folder):
    job = sb.Job.read("job.toml")
    assert {"gauges", "spacing", "noise_microstrain"} <= set(dir(job.placement))
    with pytest.raises(AttributeError, match="did you mean `gauges`"):
        job.placement.guages
    with pytest.raises(AttributeError, match="did you mean `gauges`"):
        job.placement.guages = 3
    with pytest.raises(AttributeError, match="load"):
        job.load[0].nam
    assert job.placement.get("spacing", 7.0) == 7.0 and job.placement["gauges"] == 4 and dict(job.placement) == {"gauges": 4}
    assert job.placement.spacing is None and "spacing" not in job.placement
    job.load.append({"name": "right", "grid": 11, "component": "FZ", "expected": 10.0})
    assert [load.name for load in job.load] == ["left", "middle", "right"]
    assert sb.sensitivity(job).loads == ["left", "middle", "right"]
    job.load[2].name = "end"
    del job.load[0]
    assert [load["name"] for load in sb.Job.from_dict(job.to_dict()).load] == ["middle", "end"]
    assert job.combination == [] and "combination" not in job.to_dict()
    job.combination.append({"name": "sum", "terms": {"middle": 1.0, "end": 1.0}})
    assert job.combination[0].terms.middle == 1.0
    job.check()


def test_unknown_names_and_names_given_twice_are_refused(matrix_folder):
    pandas, pyarrow = needed("pandas"), needed("pyarrow")
    job = sb.Job.read("job.toml")
    with pytest.raises(AttributeError, match="did you mean `name`"):
        job.load.append({"nam": "C.FZ"})
    with pytest.raises(TypeError, match="dictionary"):
        job.load.append("C.FZ")
    assert len(job.load) == 2
    frame = pandas.read_csv("strain.csv")
    twice = pandas.concat([frame, frame[["G1"]]], axis=1)
    # The index has the name of a column: one of the two would be lost.
    hidden = frame.set_index("run", drop=False)
    arrow = pyarrow.Table.from_arrays([pyarrow.array([1.0]), pyarrow.array([2.0])], names=["G1", "G1"])
    for table, name in ((twice, "G1"), (hidden, "run"), (arrow, "G1")):
        with pytest.raises(ValueError, match=f"more than one column {name}"):
            job.measured.strain = table
    with pytest.raises(ValueError, match="same name"):
        sb.recover_rows(S, STRAIN).to_arrow(["a", "b", "a"])
    with pytest.raises(TypeError, match="3/64"):
        sb.fleet.run(job, "T1_1.csv", shard=3)


def test_files_in_memory_are_named_relative_to_the_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    job = sb.Job.from_dict(STRIP_JOB, folder="nowhere", files={"strip.bdf": strip().encode()})
    assert len(sb.place(job).gauges) == 4


def test_the_package_states_its_version():
    assert sb.__version__.count(".") == 2 or sb.__version__ == "unknown"
    assert set(dir(sb.fleet)) == set(sb.fleet.__all__)


def test_tables_with_the_gauges_in_another_order_are_refused():
    pandas = needed("pandas")
    gauges = [f"G{i}" for i in range(len(S))]
    table = pandas.DataFrame(S, index=gauges)
    strain = pandas.DataFrame(STRAIN, columns=gauges)
    np.testing.assert_array_equal(sb.recover_rows(table, strain).loads, sb.recover_rows(S, STRAIN).loads)
    turned = strain[gauges[::-1]]
    for other in (turned, needed("polars").DataFrame(turned.to_dict("list")), needed("pyarrow").table(turned.to_dict("list"))):
        with pytest.raises(ValueError, match="differ in order"):
            sb.recover_rows(table, other)


def test_jobs_are_compared_and_read_by_key(matrix_folder):
    job, same = sb.Job.read(matrix_folder / "job.toml"), sb.Job.read(matrix_folder / "job.toml")
    assert job == same
    assert job["measured"] == job.measured and "measured" in job and "payload" not in job
    same.measured.noise_microstrain = 7.0
    assert job != same
    with pytest.raises(KeyError):
        job["mesured"]
    with pytest.raises(TypeError, match="a dictionary is needed"):
        sb.Job.from_dict([1])


@pytest.mark.parametrize(
    ("wrong", "error", "said"),
    [
        ({"digests": {"a.csv": "xyz"}}, ValueError, "SHA-256"),
        ({"digests": {"a.csv": 7}}, ValueError, "SHA-256"),
        ({"digests": ["0" * 64]}, TypeError, "dictionary"),
        ({"client": "tcp://scheduler:8786"}, TypeError, "dask.distributed.Client"),
    ],
)
def test_wrong_arguments_of_a_fleet_are_refused(wrong, error, said):
    with pytest.raises(error, match=said):
        sb.fleet.run("job.toml", ["a.csv"], **wrong)
