"""Processes a fleet on machines that are reached by SSH, with Dask.

    python dask_ssh.py JOB OUT LIST HOST [HOST ...]

The first host runs the scheduler, the others the workers. `local` means two workers on this machine, without SSH. Every host has the same Python
with strainbridge and dask[distributed]. JOB, OUT and the records have the same paths on all hosts.
"""

import sys
from pathlib import Path
from typing import Any

from dask.distributed import Client, LocalCluster, SSHCluster

import strainbridge as sb


def main(job: str, out: str, records: str, *hosts: str) -> int:
    files = [line for line in Path(records).read_text(encoding="utf-8").splitlines() if line]
    cluster: Any
    if hosts == ("local",):
        cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    else:
        cluster = SSHCluster(list(hosts), worker_options={"nthreads": 1, "n_workers": 2})
    with cluster, Client(cluster) as client:
        try:
            outcome = sb.fleet.run(job, files, out, client=client)
        except (sb.Faults, sb.fleet.FleetError) as error:
            print(error, file=sys.stderr)
            return 2
    return 0 if outcome.is_reliable else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
