"""Meshes, tables and files for other programs."""

import json

import numpy as np
import pytest
from conftest import ROOT, STRIP_JOB, needed

import strainbridge as sb

#: Two unit squares and a triangle on top.
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [0.5, 2, 0]])
CELLS = {"quad": np.array([[0, 1, 4, 3], [1, 2, 5, 4]]), "triangle": np.array([[3, 4, 6]])}


def test_a_model_is_the_mesh_it_was_made_of():
    model = sb.Model.from_arrays(POINTS, CELLS, {1: {"thickness": 1.0, "E": 1.0, "nu": 0.3}})
    mesh = model.mesh()
    np.testing.assert_array_equal(mesh.points, POINTS)
    assert mesh.celltypes.tolist() == [9, 9, 5]
    assert mesh.cells.tolist() == [4, 0, 1, 4, 3, 4, 1, 2, 5, 4, 3, 3, 4, 6]
    assert mesh.point_data["grid"].tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert mesh.cell_data["element"].tolist() == [1, 2, 3]
    assert {k: v.tolist() for k, v in mesh.blocks.items()} == {k: v.tolist() for k, v in CELLS.items()}


def test_a_mesh_is_read_by_other_programs(tmp_path):
    meshio = needed("meshio")
    reals, vectors = np.array([0.1, 0.2, 0.3]), np.random.default_rng(0).normal(size=(7, 3))
    mesh = sb.Mesh.from_arrays(POINTS, CELLS, {"u & v": vectors}, {"strain": reals, "element": [7, 8, 9]})
    mesh.write(tmp_path / "mesh.vtu")
    read = meshio.read(tmp_path / "mesh.vtu")
    np.testing.assert_array_equal(read.points, POINTS)
    assert {b.type: b.data.tolist() for b in read.cells} == {k: v.tolist() for k, v in CELLS.items()}
    np.testing.assert_array_equal(read.point_data["u & v"], vectors)
    np.testing.assert_array_equal(np.concatenate(read.cell_data["strain"]).ravel(), reals)
    assert np.concatenate(read.cell_data["element"]).ravel().tolist() == [7, 8, 9]


def test_a_mesh_goes_to_pyvista():
    # VTK has a hundred megabytes, so only `.ci/long` installs it.
    pytest.importorskip("pyvista")
    grid = sb.Mesh.from_arrays(POINTS, CELLS, cell_data={"strain": [1.0, 2.0, 3.0]}).to_pyvista()
    assert grid.n_cells == 3 and grid.cell_data["strain"].tolist() == [1.0, 2.0, 3.0]
    # Two unit squares, and a triangle of base 1 and height 1.
    assert grid.compute_cell_sizes()["Area"].tolist() == pytest.approx([1.0, 1.0, 0.5])


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: sb.Mesh.from_arrays(POINTS[:, :2], CELLS),
        lambda: sb.Mesh.from_arrays(POINTS[:5], CELLS),
        lambda: sb.Mesh.from_arrays(POINTS, {"square": CELLS["quad"]}),
        lambda: sb.Mesh.from_arrays(POINTS, CELLS, cell_data={"strain": [1.0, 2.0]}),
    ],
)
def test_arrays_that_make_no_mesh_are_refused(wrong):
    with pytest.raises(ValueError):
        wrong()


def test_answers_have_meshes(strip_folder):
    solved = sb.solve("job.toml")
    mesh = solved.mesh()
    deck = sb.Deck.read("strip.bdf").mesh()
    np.testing.assert_array_equal(mesh.points, deck.points)
    np.testing.assert_array_equal(mesh.cells, deck.cells)
    moved = next(v for k, v in mesh.point_data.items() if k.startswith("displacement 1"))
    assert moved.shape == (22, 3) and np.abs(moved).max() > 0.0
    strain = next(v for k, v in mesh.cell_data.items() if k.startswith("strain top 1"))
    table = sb.Results.read(solved.save("solved") / "results.op2").strain(subcase=1)
    np.testing.assert_allclose(1e6 * strain, table.values, rtol=1e-6, atol=1e-9)
    plan = sb.place("job.toml")
    np.testing.assert_allclose(plan.mesh().points, [g.position for g in plan.gauges], rtol=1e-12)
    with pytest.raises(KeyError, match="Deck"):
        sb.cases("job.toml").mesh()


def test_a_table_goes_to_any_reader_of_arrow(strip_folder):
    plan = sb.place("job.toml")
    table = plan.to_arrow()
    names, leverage = [g.name for g in plan.gauges], [g.leverage for g in plan.gauges]
    assert table.num_rows == len(table) == 4 and {"name", "leverage", "position"} <= set(table.column_names)
    polars = needed("polars")
    frame = polars.DataFrame(table)
    assert frame["name"].to_list() == names and frame["leverage"].to_list() == leverage
    assert frame["position"].to_list() == [g.position.tolist() for g in plan.gauges]
    pyarrow = needed("pyarrow")
    # A stream is read once. A table gives any number of streams.
    assert pyarrow.table(table).equals(pyarrow.table(plan))
    assert pyarrow.table(table).equals(pyarrow.table(table))
    assert table["name"].to_pylist() == names
    pandas = needed("pandas")
    assert pandas.DataFrame.from_arrow(table)["leverage"].tolist() == leverage
    with pytest.raises(KeyError):
        plan.to_arrow("nothing")


def test_what_json_holds_stands_in_the_table():
    pyarrow = needed("pyarrow")
    rows = [{"a": 1, "b": 0.5, "c": "x", "d": True, "e": [1.0, None], "f": {"g": 1}}, {"a": None, "b": 2, "h": 3}]
    table = pyarrow.table(sb.Table.from_records(rows))
    expected = {
        "a": [1, None], "b": [0.5, 2.0], "c": ["x", None], "d": [True, None], "e": [[1.0, None], None], "f": ['{"g":1}', None], "h": [None, 3]
    }
    assert table.to_pydict() == expected
    assert pyarrow.table(sb.Table.from_records([])).num_rows == 0


def test_loads_of_arrays_go_to_arrow():
    pyarrow = needed("pyarrow")
    S = np.random.default_rng(0).normal(size=(6, 2))
    out = sb.recover_rows(S, np.ones((5, 6)))
    table = pyarrow.table(out.to_arrow(["left", "right"]))
    assert table.column_names == ["left", "left.low", "left.high", "right", "right.low", "right.high"]
    assert table["right"].to_pylist() == out.loads[:, 1].tolist()
    with pytest.raises(ValueError):
        out.to_arrow(["left"])


def test_the_history_is_that_of_the_table(matrix_folder):
    pyarrow = needed("pyarrow")
    job = sb.Job.read("job.toml")
    job.measured.strain = "T1_1.csv"
    out = sb.recover(job)
    history = out.history()
    assert list(history) == ["time", "A.FZ", "A.FZ.low", "A.FZ.high", "B.FZ", "B.FZ.low", "B.FZ.high"]
    written = np.genfromtxt(out.save("out") / "loads.csv", delimiter=",", names=True, deletechars="")
    assert len(written) == 600
    for name in history:
        np.testing.assert_allclose(history[name], written[name.replace(".", "")] if name not in written.dtype.names else written[name], rtol=1e-4, atol=1e-4)
    assert pyarrow.table(out.to_arrow("history"))["A.FZ"].to_pylist() == history["A.FZ"].tolist()
    with pytest.raises(KeyError):
        sb.recover("job.toml").history()


def test_an_op2_of_arrays_is_read_back(tmp_path):
    rng = np.random.default_rng(1)
    ids = np.repeat([11, 12, 13], 2)
    strain = {"entity": ids, "layer": np.tile([1, 2], 3), **{c: rng.normal(size=6).astype(np.float32) for c in ("exx", "eyy", "gxy")}}
    moved = {"entity": [1, 2], "at": [1, 1], **{c: rng.normal(size=2).astype(np.float32) for c in ("t1", "t2", "t3", "r1", "r2", "r3")}}
    path = tmp_path / "ours.op2"
    sb.write_op2(path, [
        ({"quantity": "displacement", "subcase": 4}, moved),
        ({"quantity": "strain", "element_type": "CQUAD4", "subcase": 4}, strain),
    ])
    results = sb.Results.read(path)
    assert [(t.quantity, t.subcase) for t in results.tables] == [("displacement", 4), ("strain", 4)]
    back = results.table(1)
    for name in ("entity", "layer", "exx", "eyy", "gxy"):
        np.testing.assert_array_equal(back[name], strain[name])
    np.testing.assert_allclose(results.strain(4, "top").values, 1e6 * np.column_stack([strain[c][1::2] for c in ("exx", "eyy", "gxy")]), rtol=1e-6)
    # The tables that were read are written again, with equal bytes.
    sb.write_op2(tmp_path / "again.op2", [(t, results.table(i)) for i, t in enumerate(results.tables)])
    assert (tmp_path / "again.op2").read_bytes() == path.read_bytes()
    reader = needed("pyNastran.op2.op2").OP2(debug=False)
    reader.read_op2(str(path))
    theirs = reader.op2_results.strain.cquad4_strain[4]
    np.testing.assert_array_equal(theirs.data[0, :, 1], strain["exx"])
    with pytest.raises(sb.Faults, match="columns"):
        sb.write_op2(path, [({"quantity": "strain", "element_type": "CQUAD4"}, {"entity": [1], "exx": [1.0]})])
    with pytest.raises(sb.Faults, match="quantity|written"):
        sb.write_op2(path, [({"quantity": "strane"}, moved)])


def test_objects_of_pynastran_are_taken(strip_folder):
    reader = needed("pyNastran.bdf.bdf").BDF(debug=False)
    op2_reader = needed("pyNastran.op2.op2").OP2(debug=False)
    op2 = sb.solve("job.toml").save("solved") / "results.op2"
    reader.read_bdf("strip.bdf", punch=False)
    op2_reader.read_op2(str(op2))
    ours = sb.Results.read(op2, deck="strip.bdf").strain(2, "bottom", "basic")
    theirs = sb.Results.read(op2_reader, deck=reader).strain(2, "bottom", "basic")
    np.testing.assert_array_equal(ours.element, theirs.element)
    np.testing.assert_allclose(ours.values, theirs.values, rtol=1e-6, atol=1e-9)
    assert sb.Deck.read(reader).counts["CQUAD4"] == 10
    job = {**STRIP_JOB, "model": {"deck": reader, "results": [op2_reader]}}
    of_files = {**STRIP_JOB, "model": {"deck": "strip.bdf", "results": [str(op2)]}}
    mine, plain = sb.place(job), sb.place(of_files)
    assert [(g.element, g.surface) for g in mine.gauges] == [(g.element, g.surface) for g in plain.gauges]
    assert mine.log_det == pytest.approx(plain.log_det, rel=1e-6)


def test_stress_of_a_pynastran_object_becomes_strain(strip_folder):
    reader = needed("pyNastran.bdf.bdf").BDF(debug=False)
    reader.read_bdf("strip.bdf")
    n = 10
    at = {"entity": np.repeat(np.arange(1, n + 1), 2), "at": np.zeros(2 * n), "layer": np.tile([1, 2], n)}
    stress = dict.fromkeys(("fiber", "oxx", "oyy", "txy", "angle", "omax", "omin", "vm"), np.zeros(2 * n))
    sx, sy, txy = np.random.default_rng(6).normal(0.0, 100.0, (3, 2 * n)).astype(np.float32).astype(float)
    stress |= {"fiber": np.tile([-1.0, 1.0], n), "oxx": sx, "oyy": sy, "txy": txy}
    sb.write_op2("stress.op2", [({"quantity": "stress", "element_type": "CQUAD4", "subcase": 3}, {**at, **stress})])
    op2 = needed("pyNastran.op2.op2").OP2(debug=False)
    op2.read_op2("stress.op2")
    # Hooke's law in plane stress: E 210000, nu 0.3.
    expected = 1e6 * np.column_stack([sx - 0.3 * sy, sy - 0.3 * sx, 2.6 * txy])[1::2] / 210000.0
    for results in ("stress.op2", op2):
        strain = sb.Results.read(results, deck=reader).strain(3)
        assert strain.element.tolist() == list(range(1, n + 1))
        np.testing.assert_allclose(strain.values, expected, rtol=1e-6, atol=1e-9)
    with pytest.raises(sb.Faults, match="deck"):
        sb.Results.read(op2).strain(3)
    with pytest.raises(sb.Faults, match="static subcase 4"):
        sb.Results.read(op2, deck=reader).strain(4)
    job = {**STRIP_JOB, "model": {"deck": reader, "results": [op2]}, "load": [{**STRIP_JOB["load"][0], "subcase": 3}], "placement": {"gauges": 2}}
    assert len(sb.place(job).gauges) == 2


#: Decks of Nastran: stress of quadrilaterals only, plies, strain and curvature of every element, bars with stations, beams.
REFERENCE = ("msc_plate", "msc_plate_pcomp_2cases", "nx_static_elements", "nx_shell_curvature", "msc_bar_strain", "msc_svanberg_beam")


@pytest.mark.parametrize("name", REFERENCE)
def test_objects_of_pynastran_give_what_their_files_give(name):
    folder = ROOT.parent / "shared" / "nastran" / name
    if not folder.is_dir():
        pytest.skip("no reference material")
    file = next(folder.glob("*.op2"))
    op2 = needed("pyNastran.op2.op2").OP2(debug=False)
    op2.read_op2(str(file))
    ours, theirs = sb.Results.read(file), sb.Results.read(op2)
    kinds = ("CQUAD", "CTRIA", "CBAR", "CBEAM", "CROD", "CTUBE", "CONROD", "CTETRA", "CHEXA", "CPENTA")
    compared = 0

    def key(table):
        return table.quantity, table.subcase, table.element_type

    by_key = {key(t): i for i, t in enumerate(theirs.tables)}
    for i, table in enumerate(ours.tables):
        wanted = table.quantity == "displacement" or (
            table.quantity in ("stress", "strain", "ply_stress", "ply_strain") and str(table.element_type).startswith(kinds)
        )
        if not wanted or table.analysis != "statics":
            continue
        a, b = ours.table(i), theirs.table(by_key[key(table)])
        assert a.keys() == b.keys()
        for column in a:
            np.testing.assert_array_equal(a[column], b[column], err_msg=f"{key(table)} {column}")
        compared += 1
    assert compared > 1
    if any(str(t.element_type).startswith(("CQUAD", "CTRIA")) for t in ours.tables):
        deck = next(folder.glob("*.bdf"), None) or next(folder.glob("*.dat"))
        bdf = needed("pyNastran.bdf.bdf").BDF(debug=False)
        bdf.read_bdf(str(deck), xref=False)
        a, b = sb.Results.read(file, deck=deck).strain(1), sb.Results.read(op2, deck=bdf).strain(1)
        assert len(a.element)
        np.testing.assert_array_equal(a.element, b.element)
        np.testing.assert_allclose(b.values, a.values, rtol=1e-9)
    else:
        for results in (ours, theirs):
            with pytest.raises(sb.Faults, match="no strain of shells"):
                results.strain(1)


def test_cards_are_changed_and_written(strip_folder):
    text = (strip_folder / "strip.bdf").read_text()
    deck = sb.Deck.read("strip.bdf")
    # Without a change, every byte remains.
    deck.cards("GRID")
    deck.write("same.bdf")
    assert (strip_folder / "same.bdf").read_text() == text
    grids, quads = deck.cards("GRID"), deck.cards("CQUAD4")
    row = int(np.flatnonzero(grids["id"] == 3)[0])
    grids["x"][row] = [41.25, 0.0, -1.5]
    for name, column in {name: column[:-1] for name, column in quads.items()}.items():
        quads[name] = column
    quads["id"] = np.append(quads["id"], 900)
    quads["pid"] = np.append(quads["pid"], 1)
    quads["grids"] = np.vstack([quads["grids"], [[10, 11, 111, 110]]])
    quads["theta"] = np.append(quads["theta"], 30.0)
    deck.write("new.bdf")
    new = sb.Deck.read("new.bdf")
    assert new.faults == () and new.counts == deck.counts
    assert new.cards("GRID")["x"][row].tolist() == [41.25, 0.0, -1.5]
    assert new.cards("CQUAD4")["id"].tolist() == [*range(1, 10), 900]
    assert new.cards("CQUAD4")["theta"][-1] == 30.0
    # All other lines are unchanged.
    before, after = set(text.splitlines()), set((strip_folder / "new.bdf").read_text().splitlines())
    assert len(before - after) == 2
    quads["grids"] = quads["grids"] * 0.5
    with pytest.raises(sb.Faults, match="id"):
        deck.write("bad.bdf")


def test_a_folder_is_verified(strip_folder):
    out = sb.place("job.toml").save("out")
    found = sb.verify(out)
    assert found.is_reliable and list(found.differs) == [] and "gauges.csv" in found.same
    table = out / "gauges.csv"
    table.write_text(table.read_text().replace("1", "2", 1))
    found = sb.verify(out)
    assert not found.is_reliable and {d.file for d in found.differs} == {"gauges.csv"}
    with pytest.raises(sb.Faults):
        sb.verify(strip_folder)


def test_kept_solutions_are_removed(strip_folder, monkeypatch):
    monkeypatch.setenv("STRAINBRIDGE_CACHE", str(strip_folder / "kept"))
    sb.solve("job.toml")
    assert any((strip_folder / "kept").rglob("*.solution"))
    gone = sb.clean()
    assert gone.removed >= 1 and gone.bytes > 0
    assert sb.clean(strip_folder / "kept").removed == 0
    assert json.dumps(gone.to_dict())
