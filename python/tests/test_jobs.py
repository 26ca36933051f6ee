"""Jobs, faults and findings."""

import copy
import pickle

import numpy as np
import pytest
from conftest import MATRIX, MATRIX_TEXT, STRIP_JOB, strip

import strainbridge as sb


def test_a_job_of_a_dictionary_answers_as_the_file_does(strip_folder):
    of_file, of_dict = sb.place(sb.Job.read("job.toml")), sb.place(STRIP_JOB)
    assert of_file.log_det == of_dict.log_det
    assert of_file.gauges == of_dict.gauges
    assert sb.place("job.toml", threads=1).gauges == of_file.gauges


def test_files_can_be_held_in_memory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    job = sb.Job.from_dict(STRIP_JOB, folder="nowhere", files={"nowhere/strip.bdf": strip().encode()})
    assert len(sb.place(job).gauges) == 4
    assert list(tmp_path.iterdir()) == []


def test_a_job_is_changed_in_place(strip_folder):
    job = sb.Job.read("job.toml")
    assert job.placement.gauges == 4
    assert job.load[1].name == "middle"
    job.placement.gauges = np.int64(5)
    assert len(sb.place(job).gauges) == 5
    assert "gauges = 5" in job.text
    job.candidates.surfaces = ["top"]
    assert {g.surface for g in sb.place(job).gauges} == {"top"}
    # The file is unchanged.
    assert len(sb.place("job.toml").gauges) == 4
    del job.candidates
    job.placement.gauges = "many"
    with pytest.raises(sb.Faults, match="gauges"):
        job.check()
    with pytest.raises(AttributeError):
        job.placemnt = {}
    with pytest.raises(AttributeError):
        job.placemnt.gauges


def test_jobs_are_copied_and_pickled(strip_folder):
    job = sb.Job.read("job.toml")
    job.placement.gauges = 6
    for other in (pickle.loads(pickle.dumps(job)), copy.deepcopy(job)):
        assert other.to_dict() == job.to_dict()
        assert sb.place(other).gauges == sb.place(job).gauges


def test_every_fault_comes_in_one_exception(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('units = "furlong"\n[placement]\ngauges = -3\nspacingg = 1\n')
    with pytest.raises(sb.Faults) as caught:
        sb.Job.read(path)
    faults = caught.value.faults
    assert len(faults) >= 2
    assert {f.line for f in faults} >= {1, 4}
    assert all(f.file == str(path) and f.wrong and f.remedy for f in faults)
    assert "spacingg" in str(caught.value)
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.faults == faults


def test_a_missing_file_is_a_fault(tmp_path):
    with pytest.raises(sb.Faults):
        sb.Job.read(tmp_path / "none.toml")
    with pytest.raises(sb.Faults):
        sb.solve(tmp_path / "none.bdf")


def test_an_outcome_has_numbers_findings_and_words(strip_folder, tmp_path):
    plan = sb.place("job.toml")
    gauge = plan.gauges[0]
    assert isinstance(gauge.direction, np.ndarray) and gauge.direction.shape == (3,)
    assert np.linalg.norm(gauge.direction) == pytest.approx(1.0)
    assert plan["log_det"] == plan.log_det
    assert plan.is_reliable and "RELIED" not in repr(plan)
    # The job states no spacing and no model uncertainty.
    assert {f.code for f in plan.findings} >= {"model-uncertainty-unstated", "no-spacing"}
    for f in plan.findings:
        assert f.severity in ("info", "warning", "error") and f.code and f.text
    html = plan._repr_html_()
    assert "<table" in html and gauge.name in html
    with pytest.raises(AttributeError, match="log_det"):
        plan.log_dett


def test_an_outcome_that_cannot_be_relied_on_says_so(matrix_folder):
    # Two gauges with equal readings: their loads are indistinguishable.
    rows = "\n".join(f"G{g},{a},{a}" for g, (a, _) in enumerate(MATRIX))
    (matrix_folder / "S.csv").write_text(f"gauge,A.FZ,B.FZ\n{rows}\n")
    out = sb.sensitivity("job.toml")
    assert not out.is_reliable
    assert "NOT RELIABLE" in repr(out) and "cannot be relied on" in out._repr_html_()


def test_the_text_of_a_dictionary_is_read_back_as_it_was(matrix_folder):
    job = sb.Job.read("job.toml")
    assert sb.Job.from_dict(job.to_dict()).to_dict() == job.to_dict()
    assert job.text == MATRIX_TEXT
    job.title = 'quotes " and \\ and\nlines'
    assert sb.Job.from_dict(job.to_dict()).title == job.title
