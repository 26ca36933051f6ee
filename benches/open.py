"""Latency of `open` by calls like those of its page, as a ratio to a whole `place` of the command line.

    STRAINBRIDGE=target/release/strainbridge python benches/open.py JOB.toml [REPEATS]

JOB names a deck and loads with `expected`, such as `strainbridge-demo/place.toml`. The median of the repeats is printed for each call. The limits are
those of the plan of the page: a moved gauge 0.1 s, 12 gauges placed again 0.5 s, 24 gauges 1 s. Exit code 1 if a release build exceeds them.
"""

import csv
import http.client
import io
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

PROGRAM = os.environ.get("STRAINBRIDGE", "target/release/strainbridge")
LIMITS = {"move": 0.1, "place 12": 0.5, "place 24": 1.0}


def command(job: str, repeats: int) -> float:
    """Returns the seconds of `place` of the command line, with stored solutions after its first run."""
    seconds = []
    for _ in range(repeats + 1):
        with tempfile.TemporaryDirectory() as out:
            began = time.perf_counter()
            run = subprocess.run([PROGRAM, "place", job, "--out", os.path.join(out, "out")], capture_output=True, check=False)
            seconds.append(time.perf_counter() - began)
            assert run.returncode < 2, run.stderr.decode()
    return statistics.median(seconds[1:])


def calls(job: str, repeats: int) -> dict[str, float]:
    """Returns the seconds of each call, connection included."""
    server = subprocess.Popen([PROGRAM, "open", job, "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        port, token = server.stdout.readline().strip().removeprefix("http://127.0.0.1:").split("/#")

        def ask(target: str, body: dict) -> tuple[float, dict]:
            own = {"X-Strainbridge-Token": token, "Origin": f"http://127.0.0.1:{port}", "Content-Type": "application/json"}
            began = time.perf_counter()
            connection = http.client.HTTPConnection("127.0.0.1", int(port))
            connection.request("POST", target, json.dumps(body), own)
            response = connection.getresponse()
            answer = json.loads(response.read())
            connection.close()
            assert response.status == 200, answer
            return time.perf_counter() - began, answer

        out = {}
        for n in (24, 12):
            picks = f"[placement]\ngauges = {n}\n"
            ask("/place", {"picks": picks})
            timed = [ask("/place", {"picks": picks}) for _ in range(repeats)]
            out[f"place {n}"] = statistics.median(seconds for seconds, _ in timed)
        best = timed[-1][1]["gauges"]
        row = next(csv.DictReader(io.StringIO(best)))
        number = lambda name: float(row[name])
        moves = []
        for i in range(repeats):
            place = {"name": row["name"], "at": [number("x") + i, number("y"), number("z")], "side": row["surface"]}
            place["along"] = [number("dir_x"), number("dir_y"), number("dir_z")]
            moves.append(ask("/move", {"picks": picks, "gauges": best, "moved": [place]})[0])
        out["move"] = statistics.median(moves)
        return out
    finally:
        server.kill()
        server.wait()


def main() -> int:
    job, repeats = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 7
    whole = command(job, repeats)
    print(f"place of the command line: {whole:.3f} s")
    late = False
    for name, seconds in calls(job, repeats).items():
        print(f"{name}: {seconds:.3f} s, {seconds / whole:.2f} of the command, limit {LIMITS[name]} s")
        late |= seconds > LIMITS[name]
    return int(late and "release" in PROGRAM)


if __name__ == "__main__":
    sys.exit(main())
