"""Compares every function with the command, to the last digit."""

import json

import pytest

import strainbridge as sb

#: Keys that differ between runs, or that only written files have.
OF_THE_RUN = ("seconds", "tables", "peak_memory_bytes")


def same(out, result):
    ours, theirs = json.loads(out.to_json()), dict(result)
    for key in OF_THE_RUN:
        ours.pop(key, None)
        theirs.pop(key, None)
    assert ours == theirs


@pytest.mark.parametrize("name", ["sensitivity", "place", "cases", "solve", "modes", "study"])
def test_a_command_on_the_strip(name, strip_folder, command):
    if name in ("sensitivity", "study"):
        job = sb.Job.read("job.toml")
        job.gauge = [{"name": f"{e}", "element": e, "surface": "top", "direction": [1, 0, 0]} for e in (2, 4, 7, 9)]
        if name == "study":
            job.study = {"layouts": ["given"], "gauges": [4], "errors": [{"kind": "relative-uniform", "size": 0.1}], "trials": 50, "seed": 1}
        (strip_folder / "job.toml").write_text(job.text)
    same(getattr(sb, name)("job.toml"), command(name, "job.toml"))


def test_the_files_are_those_of_the_command(strip_folder, command):
    command("place", "job.toml", "--out", "theirs")
    sb.place("job.toml").save("ours")
    ours, theirs = ({p.name: p.read_bytes() for p in (strip_folder / f).iterdir()} for f in ("ours", "theirs"))
    assert ours.keys() == theirs.keys()
    differ = [n for n in ours if ours[n] != theirs[n] and n not in ("result.json", "gauges.xlsx")]
    assert differ == []
    for out in (ours, theirs):
        out["result.json"] = {k: v for k, v in json.loads(out["result.json"]).items() if k != "seconds"}
    assert ours["result.json"] == theirs["result.json"]


def test_a_deck_and_its_results(strip_folder, command):
    deck = strip_folder / "strip.bdf"
    deck.write_text(deck.read_text().replace("CEND\n", "CEND\nSUBCASE 1\nSPC = 1\nLOAD = 1\n").replace(
        "ENDDATA", "SPC1,1,123456,1,101\nFORCE,1,11,,5.,0.,0.,1.\nENDDATA"))
    solved = sb.solve(deck)
    same(solved, command("solve", deck))
    op2 = solved.save("solved") / "results.op2"
    same(sb.strains(deck, op2), command("strains", deck, op2))
    same(sb.check(deck, op2), command("check", deck, op2))
    same(sb.modes(deck, modes=3), command("modes", deck, "--modes", 3))


def test_a_job_is_proposed(strip_folder, command):
    (strip_folder / "job.toml").unlink()
    out = sb.init("strip.bdf")
    assert not (strip_folder / "job.toml").exists()
    same(out, command("init", "strip.bdf"))
    ours = (out.save("ours") / "job.toml").read_text()
    assert ours == (strip_folder / "job.toml").read_text()
    # An existing job is not overwritten.
    with pytest.raises(sb.Faults):
        sb.init("strip.bdf")


def test_loads_are_those_of_the_command_bit_by_bit(matrix_folder, command):
    out, theirs = sb.recover("job.toml"), command("recover", "job.toml")
    ours = [(f.run, f.name, f.value, f.sigma) for f in out.loads]
    assert ours == [(f["run"], f["name"], f["value"], f["sigma"]) for f in theirs["loads"]]
    assert len(ours) == 12


def test_a_fleet_is_that_of_the_command(matrix_folder, command, monkeypatch):
    monkeypatch.delenv("STRAINBRIDGE", raising=False)
    files = ["T1_1.csv", "T2_1.csv"]
    out = sb.fleet.run("job.toml", files, out="ours")
    theirs = command("fleet", "job.toml", *files, "--out", "theirs", ok=(0, 1))
    assert [v.to_dict() for v in out.vehicles] == theirs["vehicles"]
    assert (matrix_folder / "ours" / "fleet.csv").read_bytes() == (matrix_folder / "theirs" / "fleet.csv").read_bytes()

    class Client:
        """A cluster of one worker."""

        def map(self, function, *arguments, **_):
            return [function(*a) for a in zip(*arguments)]

        def gather(self, futures, errors):
            return futures

    spread = sb.fleet.run(sb.Job.read("job.toml"), files, out="spread", client=Client())
    assert spread.vehicles == out.vehicles


def test_every_command_is_a_function():
    from strainbridge import _strainbridge

    assert {"place", "recover", "solve"} <= set(_strainbridge.commands())
    assert all(hasattr(sb, name) for name in _strainbridge.commands())
    assert callable(sb.verify) and callable(sb.clean) and callable(sb.fleet.run)


def test_a_finding_explains_itself():
    code = sb.explain("gauge-suspect")
    assert code.code == "gauge-suspect" and code.cause and code.remedy and code.severity
    assert [c.code for c in sb.explain()] == sorted(c.code for c in sb.explain())
    with pytest.raises(sb.Faults, match="did you mean"):
        sb.explain("gauge-suspekt")
