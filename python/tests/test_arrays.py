"""Compares functions on bare arrays with numpy."""

import itertools

import numpy as np
import pytest

import strainbridge as sb


def log_det(rows):
    return np.linalg.slogdet(rows.T @ rows)[1]


def test_the_layout_is_the_best_of_all_layouts():
    S = np.random.default_rng(1).normal(size=(14, 3))
    plan = sb.place_rows(S, 5)
    best = max(itertools.combinations(range(14), 5), key=lambda rows: log_det(S[list(rows)]))
    assert plan.rows.tolist() == list(best)
    assert plan.proved
    assert plan.efficiency_bound == pytest.approx(1.0, abs=1e-12)


def test_the_determinant_is_that_of_the_rows_and_the_bound_is_above_it():
    S = np.random.default_rng(2).normal(size=(500, 6)) * [1.0, 10.0, 1e3, 1e-3, 1.0, 5.0]
    plan = sb.place_rows(S, 12, proof=False)
    assert len(set(plan.rows.tolist())) == 12
    assert plan.log_det == pytest.approx(log_det(S[plan.rows]), abs=1e-8)
    assert plan.upper_bound >= plan.log_det - 1e-12
    assert plan.efficiency_bound == pytest.approx(np.exp((plan.log_det - plan.upper_bound) / 6), rel=1e-12)
    assert plan.condition_number == pytest.approx(np.linalg.cond(S[plan.rows]), rel=1e-8)
    # The layout is better than the best of many random layouts.
    rng = np.random.default_rng(0)
    assert all(log_det(S[rng.choice(500, 12, replace=False)]) < plan.log_det for _ in range(300))


def test_rows_chosen_keep_the_spacing():
    rng = np.random.default_rng(4)
    S, positions = rng.normal(size=(200, 3)), rng.uniform(0.0, 100.0, (200, 3))
    at = positions[sb.place_rows(S, 8, spacing=30.0, positions=positions).rows]
    distance = np.linalg.norm(at[:, None] - at[None], axis=2)
    assert distance[np.triu_indices(8, 1)].min() >= 30.0
    with pytest.raises(sb.Faults, match="positions"):
        sb.place_rows(S, 8, spacing=30.0)


def test_weights_bound_every_layout():
    S = np.random.default_rng(21).normal(size=(14, 3))
    relaxed = sb.relax(S, 5)
    w = relaxed.weights
    assert w.shape == (14,) and w.sum() == pytest.approx(5.0) and w.min() >= 0.0 and w.max() <= 1.0 + 1e-9
    assert relaxed.log_det == pytest.approx(log_det(np.sqrt(w)[:, None] * S), abs=1e-9)
    best = max(log_det(S[list(rows)]) for rows in itertools.combinations(range(14), 5))
    assert best <= relaxed.upper_bound
    assert relaxed.log_det <= relaxed.upper_bound <= relaxed.log_det + 3 * 1.1e-6


def test_weights_of_rows_alike_are_known():
    # Each of three axes occurs ten times. The best weights with sum 6 put 2 on each axis, det = 2^3.
    relaxed = sb.relax(np.repeat(np.eye(3), 10, axis=0), 6)
    assert relaxed.upper_bound == pytest.approx(3 * np.log(2.0), abs=1e-5)
    assert relaxed.weights.reshape(3, 10).sum(axis=1) == pytest.approx([2.0, 2.0, 2.0], rel=1e-2)
    with pytest.raises(ValueError):
        sb.relax(np.eye(3), 4)
    with pytest.raises(sb.Faults, match="tolerance"):
        sb.relax(np.eye(3), 3, tolerance=0.0)


def test_strain_along_a_direction_is_that_of_the_tensor():
    rng = np.random.default_rng(22)
    n = 40
    # Warped quadrilaterals and triangles at random positions, with a strain tensor in each plane.
    corners = np.array([[0.0, 0, 0], [3, 0, 0], [3, 2, 0], [0, 2, 0]]) + rng.normal(0.0, 0.2, (n, 4, 3))
    d13, d24 = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    unit = lambda v: v / np.linalg.norm(v, axis=1, keepdims=True)  # noqa: E731
    z = unit(np.cross(d13, d24))
    x = unit(unit(d13) - unit(d24))
    axes = np.stack([x, np.cross(z, x), z], axis=1)
    e = rng.normal(0.0, 500.0, (n, 3))
    local = np.zeros((n, 3, 3))
    local[:, 0, 0], local[:, 1, 1], local[:, 0, 1] = e[:, 0], e[:, 1], e[:, 2] / 2
    local[:, 1, 0] = local[:, 0, 1]
    basic = np.einsum("nki,nkl,nlj->nij", axes, local, axes)
    direction = np.array([1.0, 0.3, 0.1])
    laid = direction - z * (z @ direction)[:, None]
    expected = np.einsum("ni,nij,nj->n", unit(laid), basic, unit(laid))
    np.testing.assert_allclose(sb.strain_along(e, direction, corners=corners), expected, rtol=1e-9, atol=1e-9)
    six = np.stack([basic[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)
    np.testing.assert_allclose(sb.strain_along(six, laid), expected, rtol=1e-9, atol=1e-9)
    # Pure shear gamma: half of it along 45 degrees, zero along the axes.
    shear = np.array([[0.0, 0.0, 100.0]])
    assert sb.strain_along(np.repeat(shear, 3, axis=0), angle_deg=[0.0, 45.0, 135.0]) == pytest.approx([0.0, 50.0, -50.0])
    side = np.array([[[0.0, 0, 0], [0, 0, 1], [0, 1, 0]]])
    assert sb.strain_along([[7.0, 3.0, 0.0]], [0, 0, 1], corners=side) == pytest.approx([7.0])
    assert np.isnan(sb.strain_along([[7.0, 3.0, 0.0]], [1, 0, 0], corners=side)).all()
    with pytest.raises(ValueError):
        sb.strain_along(shear)
    with pytest.raises(sb.Faults, match="corners"):
        sb.strain_along(shear, [1, 0, 0], corners=np.zeros((2, 4, 3)))


def test_loads_are_those_of_least_squares():
    rng = np.random.default_rng(5)
    S = rng.normal(size=(9, 4)) * 50.0
    strain = rng.normal(0.0, 3.0, (7, 4)) @ S.T + rng.normal(0.0, 1.0, (7, 9))
    out = sb.recover_rows(S, strain, noise=1.0)
    expected = np.linalg.lstsq(S, strain.T, rcond=None)[0].T
    assert out.loads.shape == (7, 4)
    np.testing.assert_allclose(out.loads, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(out.covariance, np.linalg.inv(S.T @ S), rtol=1e-9)
    sigma = np.sqrt(np.diag(out.covariance))
    np.testing.assert_allclose(out.high - out.low, np.broadcast_to(2 * 1.959963984540054 * sigma, (7, 4)), rtol=1e-9)
    assert out.is_reliable


def test_a_record_has_the_loads_of_least_squares_too_and_gaps_take_the_others():
    rng = np.random.default_rng(6)
    S = rng.normal(size=(8, 3)) * 20.0
    strain = rng.normal(0.0, 5.0, (20_000, 3)) @ S.T + rng.normal(0.0, 1.0, (20_000, 8))
    strain[17_000, 2] = np.nan
    strain[123, :6] = np.nan
    out = sb.recover_rows(S, strain)
    whole = np.isfinite(strain).all(axis=1)
    expected = np.linalg.lstsq(S, strain[whole].T, rcond=None)[0].T
    np.testing.assert_allclose(out.loads[whole], expected, rtol=1e-9, atol=1e-9)
    others = [g for g in range(8) if g != 2]
    np.testing.assert_allclose(out.loads[17_000], np.linalg.lstsq(S[others], strain[17_000, others], rcond=None)[0], rtol=1e-9)
    wider = (out.high - out.low)[17_000] > (out.high - out.low)[0]
    assert wider.all()
    # Two gauges do not determine three loads.
    assert np.isnan(out.loads[123]).any()


@pytest.mark.parametrize("rows", [1_999, 2_001])
def test_gaps_are_said_alike_of_few_rows_and_of_many(rows):
    rng = np.random.default_rng(12)
    S = rng.normal(size=(8, 3)) * 20.0
    strain = rng.normal(0.0, 5.0, (rows, 3)) @ S.T + rng.normal(0.0, 1.0, (rows, 8))
    whole = sb.recover_rows(S, strain)
    assert not any("gaps" in f.code for f in whole.findings)
    # These rows are not among the tested samples of a long record. In one row, one gauge has no reading. In the other, six of eight have none, and
    # three loads are not determined.
    strain[1_700, 2] = np.nan
    strain[123, :6] = np.nan
    out = sb.recover_rows(S, strain)
    (said,) = (f for f in out.findings if f.code == "samples-with-gaps")
    assert (said.severity, said.subject, said.measured) == ("warning", "strain", 2.0)
    assert f"In 2 of {rows} samples" in said.message
    assert "At least 1 of these samples" in said.message
    assert np.isnan(out.loads).any(axis=1).nonzero()[0].tolist() == [123]
    assert out.is_reliable
    strain[:, :6] = np.nan
    none = sb.recover_rows(S, strain)
    codes = {f.code for f in none.findings if f.severity == "error"}
    assert codes == {"loads-without-values"}
    assert not none.is_reliable


def test_intervals_hold_the_truth_nineteen_times_in_twenty():
    rng = np.random.default_rng(7)
    S = rng.normal(size=(8, 3))
    truth = rng.normal(0.0, 100.0, (5_000, 3))
    out = sb.recover_rows(S, truth @ S.T + rng.normal(0.0, 2.0, (5_000, 8)), noise=2.0)
    held = ((out.low <= truth) & (truth <= out.high)).mean()
    # The runs are independent, so the share of 15,000 intervals is 0.95 +- 0.004.
    assert 0.944 < held < 0.956


def test_readings_worse_than_the_noise_stated_widen_the_intervals_and_are_said():
    rng = np.random.default_rng(8)
    S = rng.normal(size=(12, 2)) * 10.0
    strain = rng.normal(0.0, 50.0, (40, 2)) @ S.T + rng.normal(0.0, 20.0, (40, 12))
    out = sb.recover_rows(S, strain, noise=1.0)
    assert out.covariance[0, 0] > 100.0 * np.linalg.inv(S.T @ S)[0, 0]
    assert any(f.severity in ("warning", "error") for f in out.findings)


def test_numbers_of_any_size_are_taken():
    S = np.random.default_rng(9).normal(size=(6, 2))
    loads = np.array([[1e9, -3e8], [2e7, 5e9]])
    np.testing.assert_allclose(sb.recover_rows(S, loads @ S.T, noise=1e3).loads, loads, rtol=1e-9)


@pytest.mark.parametrize("ask", [lambda S: sb.place_rows(S, 5), lambda S: sb.recover_rows(S, np.ones((2, len(S))))])
def test_loads_that_cannot_be_told_apart_raise(ask):
    S = np.random.default_rng(10).normal(size=(8, 3))
    S[:, 2] = S[:, 0] - 2.0 * S[:, 1]
    with pytest.raises(sb.Faults):
        ask(S)
    with pytest.raises(ValueError):
        ask(np.zeros((8, 2)))
    few = np.random.default_rng(10).normal(size=(2, 3))
    with pytest.raises(sb.Faults):
        ask(few)


@pytest.mark.parametrize(
    ("array", "error", "said"),
    [
        ([["a", "b"], ["c", "d"]], TypeError, "numbers are needed"),
        (np.ones(4), ValueError, "dimensions"),
        (np.full((4, 2), np.nan), ValueError, "finite"),
        (np.ones((0, 2)), ValueError, "empty"),
    ],
)
def test_what_is_wrong_with_an_array_is_said(array, error, said):
    with pytest.raises(error, match=said):
        sb.place_rows(array, 2)
    with pytest.raises(error, match=said):
        sb.recover_rows(array, np.ones((1, len(array))))


def test_arguments_that_make_no_sense_are_said():
    S = np.random.default_rng(0).normal(size=(6, 2))
    with pytest.raises(ValueError, match="columns"):
        sb.recover_rows(S, np.ones((2, 5)))
    with pytest.raises(ValueError, match="noise"):
        sb.recover_rows(S, np.ones((2, 6)), noise=0.0)
    with pytest.raises(ValueError):
        sb.place_rows(S, 7)
    with pytest.raises(ValueError):
        sb.place_rows(S, 0)


def test_cycles_are_those_of_the_standard():
    # ASTM E1049-85, figure 6: ranges 3, 4, 6, 8, 9 with counts 0.5, 1.5, 0.5, 1, 0.5.
    cycles = sb.rainflow(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    count = {r: cycles["count"][cycles["range"] == r].sum() for r in (3.0, 4.0, 6.0, 8.0, 9.0)}
    assert count == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    assert cycles["count"].sum() == 4.0


def test_a_calibration_learns_the_matrix_that_made_the_readings():
    rng = np.random.default_rng(11)
    S = rng.normal(size=(6, 2)) * 10.0
    loads = rng.normal(0.0, 30.0, (12, 2))
    strain = loads @ S.T + rng.normal(0.0, 0.5, (12, 6))
    learnt = sb.calibrate_rows(strain, loads, noise=0.5)
    # Least squares: the sd of an entry is the noise divided by the root of the sum of squares of its load.
    sd = 0.5 / np.sqrt((loads**2).sum(axis=0))
    assert (np.abs(learnt.S - S) < 6.0 * sd).all()
    assert learnt.outcome.calibration.runs == 12
    better = sb.calibrate_rows(strain[:3], loads[:3], noise=0.5, prior=S, prior_rel=0.01)
    assert np.abs(better.S / S - 1.0).max() < 0.05
    with pytest.raises(ValueError, match="runs"):
        sb.calibrate_rows(strain, loads[:5])
