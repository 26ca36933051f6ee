"""Processes one part of a fleet, for a scheduler that gives every task a number, or merges all parts.

    python shard.py JOB OUT 3/64 LIST      the third of 64 parts of the records in LIST, one path or URL per line
    python shard.py JOB OUT merge          fleet.csv and the report from the stored results of all parts in OUT

A part ends with exit code 0 if it is complete, independently of its findings. The merge ends with exit code 1 if a finding is an error. Faulty input
ends with 2.
"""

import sys
from pathlib import Path

import strainbridge as sb


def main(job: str, out: str, part: str, *lists: str) -> int:
    try:
        if part == "merge":
            return 0 if sb.fleet.merge(job, out).is_reliable else 1
        files = [line for name in lists for line in Path(name).read_text(encoding="utf-8").splitlines() if line]
        sb.fleet.run(job, files, out, shard=part)
        return 0
    except sb.Faults as faults:
        print(faults, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
