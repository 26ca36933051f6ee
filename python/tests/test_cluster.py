"""The scripts of `examples/cluster` with the variables of their schedulers give the same bytes as one machine."""

import os
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT, needed

import strainbridge as sb

SCRIPTS = ROOT / "examples" / "cluster"


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    """Returns a folder with the four records of `examples/fleet`, their list, and `fleet.csv` of one machine."""
    folder = tmp_path_factory.mktemp("cluster")
    shutil.copytree(ROOT / "examples" / "fleet", folder, dirs_exist_ok=True)
    files = [str(f) for f in sorted(folder.glob("?_2026-*.csv"))]
    (folder / "records.txt").write_text("\n".join(files) + "\n")
    sb.fleet.run(folder / "fleet.toml", files, folder / "here")
    return folder, (folder / "here" / "fleet.csv").read_bytes()


def call(arguments, codes=(0,), **variables):
    env = {**os.environ, "PYTHON": sys.executable, **variables}
    done = subprocess.run([str(a) for a in arguments], env=env, cwd=SCRIPTS, capture_output=True, text=True, timeout=300)
    assert done.returncode in codes, (done.returncode, done.stdout, done.stderr)
    return done


def test_the_slurm_array_writes_the_same_bytes(four):
    folder, here = four
    job, out, records = folder / "fleet.toml", folder / "slurm", folder / "records.txt"
    parts = [line.rpartition("-")[2] for line in (SCRIPTS / "slurm.sh").read_text().splitlines() if line.startswith("#SBATCH --array=1-")]
    assert parts == ["4"]
    for n in (3, 1, 4, 2):
        call(["bash", SCRIPTS / "slurm.sh", job, out, records], SLURM_ARRAY_TASK_ID=str(n), SLURM_ARRAY_TASK_COUNT=parts[0])
    call(["bash", SCRIPTS / "merge.sh", job, out], (0, 1))
    assert (out / "fleet.csv").read_bytes() == here


def test_a_part_with_bad_input_ends_with_2(four):
    folder, _ = four
    (folder / "lost.txt").write_text(f"{folder}/A_2026-06-01.csv\n")
    variables = {"SLURM_ARRAY_TASK_ID": "1", "SLURM_ARRAY_TASK_COUNT": "4"}
    done = call(["bash", SCRIPTS / "slurm.sh", folder / "fleet.toml", folder / "bad", folder / "lost.txt"], (2,), **variables)
    assert "A_2026-06-01.csv" in done.stderr and "does not exist" in done.stderr


def test_the_kubernetes_job_writes_the_same_bytes(four):
    yaml = needed("yaml")
    folder, here = four
    shutil.copy(folder / "fleet.toml", folder / "job.toml")
    jobs = list(yaml.safe_load_all((SCRIPTS / "kubernetes.yaml").read_text()))
    assert [j["metadata"]["name"] for j in jobs] == ["fleet", "fleet-merge"]

    def pod(job, codes, **variables):
        container = job["spec"]["template"]["spec"]["containers"][0]
        given = {e["name"]: e["value"] for e in container.get("env", [])}
        # Replaces the paths of the volume and of the program by local ones.
        line = container["args"][0].replace("/data/", f"{folder}/").replace("exec python", f"exec {sys.executable}")
        call([*container["command"], line], codes, **given, **variables)

    spec = jobs[0]["spec"]
    assert spec["completionMode"] == "Indexed"
    parts = next(e["value"] for e in spec["template"]["spec"]["containers"][0]["env"] if e["name"] == "PARTS")
    assert int(parts) == spec["completions"]
    shutil.rmtree(folder / "fleet", ignore_errors=True)
    for index in range(spec["completions"]):
        pod(jobs[0], (0,), JOB_COMPLETION_INDEX=str(index))
    pod(jobs[1], (0, 1))
    assert (folder / "fleet" / "fleet.csv").read_bytes() == here


def test_the_dask_script_writes_the_same_bytes(four):
    needed("distributed")
    folder, here = four
    call([sys.executable, SCRIPTS / "dask_ssh.py", folder / "fleet.toml", folder / "dask", folder / "records.txt", "local"], (0, 1))
    assert (folder / "dask" / "fleet.csv").read_bytes() == here
