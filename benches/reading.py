"""Whole processes that read a deck or an OP2: pyNastran compared with `strainbridge check`, medians of five.

    STRAINBRIDGE=target/release/strainbridge python benches/reading.py DECK_OR_OP2...

Needs pyNastran. `check` reads every card or block, hashes the file and reports its contents.
"""

import os
import statistics
import subprocess
import sys
import time

PYNASTRAN = {
    False: "import sys; from pyNastran.bdf.bdf import read_bdf; read_bdf(sys.argv[1], xref=False, punch=None, debug=None)",
    True: "import sys; from pyNastran.op2.op2 import read_op2; read_op2(sys.argv[1], build_dataframe=False, debug=None)",
}


def median(call, ends):
    """Returns the seconds of a process that ends with one of these codes."""
    seconds = []
    for _ in range(5):
        begin = time.perf_counter()
        done = subprocess.run(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        seconds.append(time.perf_counter() - begin)
        if done.returncode not in ends:
            raise RuntimeError(done.stderr.decode())
    return statistics.median(seconds)


if __name__ == "__main__":
    for path in sys.argv[1:]:
        theirs = median([sys.executable, "-c", PYNASTRAN[path.endswith(".op2")], path], (0,))
        ours = median([os.environ.get("STRAINBRIDGE", "strainbridge"), "check", path], (0, 1))
        size = os.path.getsize(path) / 1e6
        print(f"{os.path.basename(path)}, {size:.1f} MB: pyNastran {theirs:.2f} s, strainbridge {ours:.3f} s, {theirs / ours:.0f} times")
