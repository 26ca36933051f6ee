"""Compares every function with the command, to the last digit."""

import json

import numpy as np
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


def test_a_quarter_truck_moves_as_its_equation_of_motion(tmp_path):
    # A sine of force on the wheel of two masses at rest. The stretch r of the spring obeys mu r'' + c r' + k r = -mu F / m_f.
    m_b, m_f, k, c = 3200.0, 1400.0, 4.8e5, 5600.0
    rate, w, size = 2000.0, 2.0 * np.pi * 3.0, 5000.0
    t = np.arange(8001) / rate
    force = size * np.sin(w * t)
    mu = m_b * m_f / (m_b + m_f)
    decay = c / (2.0 * mu)
    turn = np.sqrt(k / mu - decay**2)
    forced = -size / m_f / (k / mu - w**2 + 2j * decay * w)
    start, speed = forced.imag, (1j * w * forced).imag
    # The free motion that cancels place and speed of the forced motion at the start.
    root = complex(-decay, turn)
    free = complex(-start, -(-speed + decay * -start) / turn)
    r = (forced * np.exp(1j * w * t)).imag + (free * np.exp(root * t)).real
    rate_of_r = (1j * w * forced * np.exp(1j * w * t)).imag + (root * free * np.exp(root * t)).real
    spring = k * r + c * rate_of_r
    rows = "\n".join(f"{a:.6f},{b:.12e}" for a, b in zip(t, force))
    (tmp_path / "force.csv").write_text(f"time [s],f_wheel [N]\n{rows}\n")
    vehicle = {"model": "front2", "terms": ["k_s", "c_s"], "data": "force.csv", "input": "wheel_force"}
    vehicle["known"] = {"m_b": m_b, "m_f": m_f, "k_s": k, "c_s": c}
    out = sb.simulate(sb.Job.from_dict({"units": "m-kg-s", "vehicle": vehicle}, folder=tmp_path))
    assert out.samples == len(t) and out.is_reliable
    assert out.fastest_mode_hz == pytest.approx(np.sqrt(k / mu) / (2.0 * np.pi), rel=1e-9)
    saved = out.save(tmp_path / "out") / "response.csv"
    names = saved.read_text().partition("\n")[0].split(",")
    columns = dict(zip(names, np.loadtxt(saved, delimiter=",", skiprows=1).T))
    for name, expected in (("a_body", -spring / m_b), ("a_wheel", (force + spring) / m_f)):
        found = next(v for n, v in columns.items() if n.split(" ")[0] == name)
        # Lines between samples of the sine are (w dt)^2 / 8 = 1.1e-5 of its size too low.
        np.testing.assert_allclose(found, expected, atol=5e-5 * np.abs(expected).max())


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
