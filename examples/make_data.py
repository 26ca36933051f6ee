"""Generates the measured data of the examples `quarter_truck`, `rig`, `frame` and `fleet`, from models in this file.

Run it in this folder. It needs numpy. The folders already contain the results, so it is not necessary to run it.
"""

import numpy as np


def road(rng, n, dt):
    """Returns a rough road in m: integrated noise without frequencies below half a hertz."""
    slope = rng.normal(0.0, 1.0, n)
    height, out = 0.0, np.zeros(n)
    for i in range(n):
        height += dt * (slope[i] * 1.2 - 2.0 * np.pi * 0.5 * height)
        out[i] = height
    return out


def ride(seed, seconds, k_3):
    """Simulates a quarter truck on such a road: accelerations of body and wheel (with gravity), m/s2, and wheel force, N."""
    m_b, m_w, k_s, c_s, k_t, g = 3000.0, 600.0, 4.0e5, 1.1e4, 1.3e6, 9.81
    rate, inner = 200, 20
    dt = 1.0 / (rate * inner)
    rng = np.random.default_rng(seed)
    # The road is smooth over a fiftieth of a second, because a tyre has a footprint.
    z = np.convolve(road(rng, seconds * rate * inner, dt), np.ones(80) / 80.0, "same") * 1.5
    x = np.zeros(4)

    def motion(x, z):
        stretch, speed = x[0] - x[1], x[2] - x[3]
        spring = k_s * stretch + c_s * speed + k_3 * stretch**3
        tyre = k_t * (z - x[1])
        return np.array([x[2], x[3], -spring / m_b, (spring + tyre) / m_w]), tyre

    rows = []
    for i in range(len(z) - 1):
        if i % inner == 0:
            v, tyre = motion(x, z[i])
            rows.append([i * dt, v[2] + g, v[3] + g, tyre + (m_b + m_w) * g])
        middle = 0.5 * (z[i] + z[i + 1])
        a = motion(x, z[i])[0]
        b = motion(x + 0.5 * dt * a, middle)[0]
        c = motion(x + 0.5 * dt * b, middle)[0]
        d = motion(x + dt * c, z[i + 1])[0]
        x = x + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    rows = np.array(rows)
    rows[:, 1:3] += rng.normal(0.0, 0.02, (len(rows), 2))
    rows[:, 3] += rng.normal(0.0, 60.0, len(rows))
    return rows


def write_ride(path, rows):
    with open(path, "w") as f:
        f.write("t,a_body,a_wheel,f_wheel\n")
        for t, a, w, force in rows:
            f.write(f"{t:.3f},{a:.3f},{w:.3f},{force:.0f}\n")


def shaken(seed, seconds, mass, damping, stiffness, size):
    """Returns time, force on the first mass in N, displacements and accelerations of masses at 200 Hz.

    The force is random with the given size (N rms, 2 to 30 Hz).
    """
    rate, inner = 200, 20
    dt = 1.0 / (rate * inner)
    n = seconds * rate * inner
    rng = np.random.default_rng(seed)
    spectrum, hz = np.fft.rfft(rng.normal(0.0, 1.0, n)), np.fft.rfftfreq(n, dt)
    spectrum[(hz < 2.0) | (hz > 30.0)] = 0.0
    u = np.fft.irfft(spectrum, n)
    u *= size / u.std()
    k = len(mass)
    a = np.zeros((2 * k, 2 * k))
    a[:k, k:] = np.eye(k)
    a[k:, :k], a[k:, k:] = -stiffness / mass[:, None], -damping / mass[:, None]
    b = np.zeros(2 * k)
    b[k] = 1.0 / mass[0]
    x, rows = np.zeros(2 * k), []
    for i in range(n - 1):
        if i % inner == 0:
            rows.append([i * dt, u[i], *x[:k], *(a @ x + b * u[i])[k:]])
        middle = 0.5 * (u[i] + u[i + 1])
        p = a @ x + b * u[i]
        q = a @ (x + 0.5 * dt * p) + b * middle
        r = a @ (x + 0.5 * dt * q) + b * middle
        s = a @ (x + dt * r) + b * u[i + 1]
        x = x + dt / 6.0 * (p + 2.0 * q + 2.0 * r + s)
    return np.array(rows), rng


def oscillator(path, seed, seconds):
    """Simulates 2 kg on a spring of 8,000 N/m with 15 N s/m: displacement, m, and force, N."""
    rows, rng = shaken(seed, seconds, np.array([2.0]), np.array([[15.0]]), np.array([[8000.0]]), 20.0)
    with open(path, "w") as f:
        f.write("t,y,u\n")
        for t, u, y, _ in rows:
            f.write(f"{t:.3f},{y + rng.normal(0.0, 1e-5):.6f},{u + rng.normal(0.0, 0.1):.2f}\n")


def two_masses(path, seed, seconds):
    """Simulates 60 kg on 400 kg on the ground, with springs of 9e4 and 6e5 N/m and dampers of 700 and 4,000 N s/m.

    The record has accelerations with gravity, and the force on the first mass.
    """
    k, c = [9.0e4, 6.0e5], [700.0, 4000.0]
    chain = lambda v: np.array([[v[0], -v[0]], [-v[0], v[0] + v[1]]])
    rows, rng = shaken(seed, seconds, np.array([60.0, 400.0]), chain(c), chain(k), 500.0)
    with open(path, "w") as f:
        f.write("t,a_1,a_2,f_1\n")
        for t, u, _, _, a, b in rows:
            noise = rng.normal(0.0, 1.0, 3) * [0.02, 0.02, 3.0]
            f.write(f"{t:.3f},{a + 9.81 + noise[0]:.3f},{b + 9.81 + noise[1]:.3f},{u + noise[2]:.1f}\n")


LENGTH, HALF_WIDTH, HEIGHT, FLANGE, BAY = 4000.0, 400.0, 200.0, 60.0, 250.0


def deck():
    """Writes a three-wheeled carrier, mm t s: two C rails, five cross plates, one grid for the payload. Statics gives its wheel forces."""
    grids, elements = {}, []

    def grid(x, y, z):
        return grids.setdefault((round(x, 3), round(y, 3), round(z, 3)), len(grids) + 1)

    def quad(p, *corners):
        elements.append((p, [grid(*c) for c in corners]))

    bays = int(LENGTH / BAY)
    for side in (-1.0, 1.0):
        y, rim = side * HALF_WIDTH, side * (HALF_WIDTH + FLANGE)
        p = 1 if side < 0 else 2
        for b in range(bays):
            a, c = b * BAY, (b + 1) * BAY
            for low, high in ((0.0, HEIGHT / 2), (HEIGHT / 2, HEIGHT)):
                quad(p, (a, y, low), (c, y, low), (c, y, high), (a, y, high))
            for z in (0.0, HEIGHT):
                quad(p, (a, y, z), (c, y, z), (c, rim, z), (a, rim, z))
    cells = 8
    width = 2.0 * HALF_WIDTH / cells
    for x in np.linspace(0.0, LENGTH, 5):
        for i in range(cells):
            a, c = -HALF_WIDTH + i * width, -HALF_WIDTH + (i + 1) * width
            for low, high in ((0.0, HEIGHT / 2), (HEIGHT / 2, HEIGHT)):
                quad(3, (x, a, low), (x, c, low), (x, c, high), (x, a, high))
    lines = ["$ A three-wheeled carrier, mm t s; made by make_data.py", "SOL 101", "CEND", "STRAIN(FIBER) = ALL", "BEGIN BULK"]
    lines += ["PARAM,INREL,-2", "MAT1,1,2.1+5,,0.3,7.85-9"]
    lines += ["$ left rail", "PSHELL,1,1,6.,1,,1", "$ right rail", "PSHELL,2,1,6.,1,,1", "$ cross plates", "PSHELL,3,1,8.,1,,1"]
    lines += [f"GRID,{i},,{x},{y},{z}" for (x, y, z), i in grids.items()]
    lines += [f"CQUAD4,{n},{p},{','.join(map(str, c))}" for n, (p, c) in enumerate(elements, 1)]
    top = [grid(x, s * HALF_WIDTH, HEIGHT) for x in (1500.0, 2000.0, 2500.0) for s in (-1.0, 1.0)]
    lines += [f"GRID,901,,{PAYLOAD[0]},{PAYLOAD[1]},250."]
    lines += [f"RBE3,901,,901,123456,1.,123,{','.join(map(str, top[:2]))}", f",{','.join(map(str, top[2:]))}"]
    lines += ["ENDDATA", ""]
    wheels = {"N": grid(0.0, 0.0, 0.0), "L": grid(3500.0, -HALF_WIDTH, 0.0), "R": grid(3500.0, HALF_WIDTH, 0.0)}
    return "\n".join(lines), wheels


PAYLOAD = (2000.0, 0.0)
WHEELS = {"N": (0.0, 0.0), "L": (3500.0, -HALF_WIDTH), "R": (3500.0, HALF_WIDTH)}
GRAVITY = 9.80665


def wheel_forces(mass, x, y):
    """Returns the wheel forces in N under a mass (t) at a place, from three equations of statics."""
    w = mass * GRAVITY * 1000.0
    rows = [[1.0, 1.0, 1.0], [p[0] for p in WHEELS.values()], [p[1] for p in WHEELS.values()]]
    return np.linalg.solve(np.array(rows), w * np.array([1.0, x, y]))


if __name__ == "__main__":
    import sys

    text, wheels = deck()
    with open("frame/frame.bdf", "w") as f:
        f.write(text)
    print(wheels)
    if "--deck" in sys.argv:
        sys.exit()
    write_ride("quarter_truck/data.csv", ride(1, 24, 0.0))
    write_ride("quarter_truck/holdout.csv", ride(2, 16, 0.0))
    write_ride("quarter_truck/data_worn.csv", ride(3, 24, 2.0e8))
    write_ride("quarter_truck/holdout_worn.csv", ride(4, 16, 2.0e8))
    write_ride("quarter_truck/data.csv", ride(1, 24, 0.0))
    write_ride("quarter_truck/holdout.csv", ride(2, 16, 0.0))
    write_ride("quarter_truck/data_worn.csv", ride(3, 24, 2.0e8))
    write_ride("quarter_truck/holdout_worn.csv", ride(4, 16, 2.0e8))
    oscillator("rig/oscillator.csv", 6, 20)
    oscillator("rig/oscillator_holdout.csv", 7, 12)
    two_masses("rig/rig.csv", 8, 20)
    two_masses("rig/rig_holdout.csv", 9, 12)
    # `strainbridge sensitivity recover.toml` wrote the strain of the gauges per newton.
    table = [line.split(",") for line in open("frame/sensitivity.csv").read().split()]
    names, gauges = table[0][1:], [row[0] for row in table[1:]]
    s = np.array([[float(v) for v in row[1:]] for row in table[1:]])
    rng = np.random.default_rng(5)
    runs = [(0.3, 2.0, 0.0), (0.6, 2.0, 0.1), (0.9, 2.1, -0.1), (1.2, 1.9, 0.0), (0.5, 2.3, 0.15), (0.8, 1.7, -0.15), (1.0, 2.0, 0.05), (0.7, 2.2, 0.0), (1.1, 1.8, 0.1)]
    strain, listed = [], []
    for i, (mass, x, y) in enumerate(runs, 1):
        f = wheel_forces(mass, 1000.0 * x, 1000.0 * y)
        w = mass * GRAVITY * 1000.0
        dx, dy = 1000.0 * x - PAYLOAD[0], 1000.0 * y - PAYLOAD[1]
        loads = dict(zip(["N.FZ", "L.FZ", "R.FZ"], f)) | {"payload.FZ": -w, "payload.MX": -w * dy, "payload.MY": w * dx}
        strain.append(s @ np.array([loads[n] for n in names]) + rng.normal(0.0, 0.5, len(gauges)))
        measured = f / 1000.0 + rng.normal(0.0, 0.02, 3)
        listed.append([f"R{i:02}", f"{1000.0 * mass:.0f}", f"{x:.3f}", f"{y:.3f}", *(f"{v:.3f}" for v in measured)])

    def write(path, header, rows):
        with open(path, "w") as f:
            f.writelines(",".join(r) + "\n" for r in [header, *rows])

    def rows_of(readings):
        return [[f"R{i:02}", *(f"{v:.2f}" for v in row)] for i, row in enumerate(readings, 1)]

    write("frame/strain.csv", ["run", *gauges], rows_of(strain))
    wired = np.array(strain)
    wired[:, 4] = -wired[:, 4]
    write("frame/strain_wired.csv", ["run", *gauges], rows_of(wired))
    write("frame/runs.csv", ["run", "payload_mass", "payload_x", "payload_y", "N.FZ", "L.FZ", "R.FZ"], listed)
    # S as a matrix, per kN. For the payload, per kg, and per kg and metre of its displacement.
    column = {n: s[:, i] for i, n in enumerate(names)}
    wheels = [[g, *(f"{1000.0 * column[n][i]:.6f}" for n in ["N.FZ", "L.FZ", "R.FZ"])] for i, g in enumerate(gauges)]
    write("frame/s_wheels.csv", ["gauge", "N.FZ", "L.FZ", "R.FZ"], wheels)
    signature = [[-GRAVITY * column["payload.FZ"][i], GRAVITY * 1000.0 * column["payload.MY"][i], -GRAVITY * 1000.0 * column["payload.MX"][i], 0.0] for i in range(len(gauges))]
    write("frame/s_payload.csv", ["gauge", "b0", "b_dx", "b_dy", "b_dxdy"], [[g, *(f"{v:.9f}" for v in r)] for g, r in zip(gauges, signature)])
    # The empty carrier: a frame of 0.1708 t (from `check`) and a gearbox of 0.25 t at 3.0 m, 0.1 m, which is not in the model.
    empty = (wheel_forces(0.170816, 2000.0, 0.0) + wheel_forces(0.25, 3000.0, 100.0)) / 1000.0
    write("frame/empty.csv", ["run", "N.FZ", "L.FZ", "R.FZ"], [["empty", *(f"{v:.4f}" for v in empty)]])
    # Two carriers on two days each. B drives the same road as A with a fifth more load.
    write("fleet/s_wheels.csv", ["gauge", "N.FZ", "L.FZ", "R.FZ"], wheels)
    kilo = np.array([[float(v) for v in row[1:]] for row in wheels])
    time = np.arange(0.0, 20.0, 0.05)
    for day in (1, 2):
        phase = 2.0 * np.pi * time * (1.0 + 0.1 * day)
        load = np.array([2.0 * np.sin(phase), 1.5 * np.sin(phase + 1.0), 1.5 * np.sin(phase - 1.0)])
        for vehicle, factor in (("A", 1.0), ("B", 1.2)):
            readings = (kilo @ (factor * load)).T + rng.normal(0.0, 0.05, (len(time), len(gauges)))
            rows = [[f"{t:.2f}", *(f"{v:.1f}" for v in r)] for t, r in zip(time, readings)]
            write(f"fleet/{vehicle}_2026-05-0{day}.csv", ["time", *gauges], rows)
