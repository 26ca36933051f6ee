"""Decks, result files and models of arrays."""

import csv

import numpy as np
import pytest
from conftest import ROOT, STRIP_JOB

import strainbridge as sb


@pytest.fixture
def solved(strip_folder):
    """Returns the folder with the solved unit loads of the strip."""
    return sb.solve("job.toml").save(strip_folder / "solved")


def test_cards_are_columns(strip_folder):
    deck = sb.Deck.read("strip.bdf")
    assert deck.counts["GRID"] == 22 and deck.faults == ()
    quads = deck.cards("CQUAD4")
    assert quads["grids"].shape == (10, 4) and quads["grids"][2].tolist() == [3, 4, 104, 103]
    assert quads["pid"].tolist() == [1] * 10
    grids = deck.cards("GRID")
    assert grids["x"][2].tolist() == [20.0, 0.0, 0.0]
    assert deck.positions()["id"].tolist() == sorted(grids["id"].tolist())
    with pytest.raises(KeyError, match="GRID"):
        deck.cards("PBARL")
    with pytest.raises(sb.Faults):
        sb.Deck.read("none.bdf")


def test_strain_of_a_result_file_is_that_of_the_tables(solved, strip_folder):
    op2 = solved / "results.op2"
    with open(sb.strains("strip.bdf", op2).save("tables") / "strains.csv") as file:
        rows = [r for r in csv.DictReader(file) if r["subcase"] == "2" and r["surface"] == "top" and r["location"] == "centre"]
    strain = sb.Results.read(op2, deck="strip.bdf").strain(subcase=2, surface="top", frame="basic")
    assert strain.element.tolist() == [int(r["element"]) for r in rows] == list(range(1, 11))
    # The table has six digits or more.
    np.testing.assert_allclose(strain.values, [[float(r[c]) for c in strain.columns] for r in rows], rtol=1e-5, atol=1e-9)
    alone = sb.Results.read(op2).strain(subcase=2)
    np.testing.assert_allclose(alone.values, [[float(r[c]) for c in alone.columns] for r in rows], rtol=1e-5, atol=1e-9)
    bottom = sb.Results.read(op2, deck="strip.bdf").strain(subcase=2, surface="bottom")
    np.testing.assert_allclose(bottom.values, -alone.values, rtol=1e-5, atol=1e-6)
    with pytest.raises(sb.Faults):
        sb.Results.read(op2).strain(subcase=77)


def test_tables_of_a_result_file(solved):
    results = sb.Results.read(solved / "results.op2")
    number = next(i for i, t in enumerate(results.tables) if t.quantity == "strain" and t.subcase == 1)
    table = results.table(number)
    assert {"entity", "at", "layer", "exx", "eyy", "gxy"} <= table.keys()
    with pytest.raises(IndexError):
        results.table(len(results.tables))
    with pytest.raises(sb.Faults):
        sb.Results.read(ROOT / "README.md")


def test_a_model_of_arrays_answers_as_its_deck_does(strip_folder):
    x = np.array([[20.0 * i, 20.0 * j, 0.0] for j in range(2) for i in range(11)])
    quads = np.array([[i, i + 1, i + 12, i + 11] for i in range(10)])
    model = sb.Model.from_arrays(x, [("quad", quads)], {1: {"thickness": 2.0, "E": 210000.0, "nu": 0.3, "rho": 7.85e-9}})
    job = {k: v for k, v in STRIP_JOB.items() if k != "model"}
    job["load"] = [{"name": "left", "point": 0, "component": "FZ", "expected": 10.0}, {"name": "middle", "point": 5, "component": "FZ", "expected": 10.0}]
    ours, theirs = sb.place(model.job(job)), sb.place("job.toml")
    assert ours.log_det == pytest.approx(theirs.log_det, rel=1e-9)
    assert [g.element for g in ours.gauges] == [g.element for g in theirs.gauges]
    assert model.solve(job).grids == 22
    with pytest.raises(ValueError, match="points"):
        sb.Model.from_arrays(x, {"quad": quads + 20}, {1: {"thickness": 1.0, "E": 1.0, "nu": 0.3}})
