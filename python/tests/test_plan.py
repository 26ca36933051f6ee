"""A plan of gauges in memory."""

import copy

import numpy as np
import pytest

import strainbridge as sb


def sigmas(layout):
    return [load.sigma for load in layout.load_sigma]


def test_a_plan_chooses_the_gauges_of_the_command(strip_folder):
    job = sb.Job.read("job.toml")
    plan = sb.Plan.read(job)
    assert plan.place(job) == sb.place(job)
    # Another number of gauges: the plan keeps the model.
    job.placement.gauges = 6
    six = plan.place(job, threads=1)
    assert six == sb.place(job)
    assert len(sb.Plan.gauges(six)) == 6


def test_a_job_with_other_loads_is_refused(strip_folder):
    job = sb.Job.read("job.toml")
    plan = sb.Plan.read(job)
    best = plan.place(job)
    other = sb.Job.read("job.toml")
    other.load[0].component = "FX" if other.load[0].component != "FX" else "FY"
    with pytest.raises(sb.Faults, match="loads of the job differ"):
        plan.place(other)
    with pytest.raises(sb.Faults, match="loads of the job differ"):
        plan.evaluate(other, sb.Plan.gauges(best), best)


def test_the_gauges_of_a_layout_have_its_values(strip_folder):
    job = sb.Job.read("job.toml")
    plan = sb.Plan.read(job)
    best = plan.place(job)
    again = plan.evaluate(job, sb.Plan.gauges(best), best)
    np.testing.assert_allclose(sigmas(again), sigmas(best), rtol=1e-9)
    assert again.log_det == pytest.approx(best.log_det, abs=1e-9)


def test_a_moved_gauge_is_never_better_than_the_bound(strip_folder):
    job = sb.Job.read("job.toml")
    plan = sb.Plan.read(job)
    best = plan.place(job)
    moved = set()
    # Centres of the elements, so that every place is a candidate.
    for x in np.arange(10.0, 200.0, 20.0):
        rows = sb.Plan.gauges(best)
        rows[0].update(element="", x=str(x), y="10", z="0")
        layout = plan.evaluate(job, rows, best)
        assert layout.log_det <= best.upper_bound + 1e-9
        assert 0.0 <= layout.efficiency_bound <= 1.0
        moved.add(round(layout.log_det, 9))
    assert len(moved) > 3


def test_tables_and_faults(strip_folder):
    pandas = pytest.importorskip("pandas")
    job = sb.Job.read("job.toml")
    plan = sb.Plan.read(job)
    best = plan.place(job)
    table = pandas.DataFrame(sb.Plan.gauges(best))
    assert sigmas(plan.evaluate(job, table, best)) == pytest.approx(sigmas(best), rel=1e-9)
    rows = sb.Plan.gauges(best)
    rows[0]["element"] = "999999"
    with pytest.raises(sb.Faults):
        plan.evaluate(job, rows, best)
    with pytest.raises(sb.Faults, match="best"):
        plan.evaluate(job, sb.Plan.gauges(best), sb.check("strip.bdf"))
    for wrong in (None, "gauges.csv", []):
        with pytest.raises(TypeError):
            plan.evaluate(job, wrong, best)
    with pytest.raises(TypeError):
        plan.evaluate(job, rows, copy.deepcopy(best))
