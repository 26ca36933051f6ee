"""Cost of a call from Python: time of the call divided by the time in the library, the smallest of five.

    python benches/python.py          (with the package installed)
"""

import time

import numpy as np

from strainbridge import _strainbridge as engine


def ratio(ask, calls=5):
    """Returns the seconds of a call divided by the seconds that the library spent in it."""
    found = []
    for _ in range(calls):
        begin = time.perf_counter()
        inside = ask()["seconds"]
        found.append((time.perf_counter() - begin) / inside)
    return min(found)


if __name__ == "__main__":
    random = np.random.default_rng(3)
    strain = random.normal(size=(1_000_000, 41))
    s = random.normal(size=(41, 6))
    rows = random.normal(size=(2_000_000, 6))
    print(f"recover_rows, 1,000,000 x 41: {ratio(lambda: engine.recover_rows(s, strain, 1.0, None)):.3f}")
    print(f"place_rows, 2,000,000 x 6: {ratio(lambda: engine.place_rows(rows, 12, None, None, False, None)):.3f}")
