"""Writes scipy_series.json: reference results of scipy for src/series/tests.rs. Run: python3 scipy_series.py"""
import json, os
import numpy as np
from scipy import signal

rng = np.random.default_rng(7)
n, fs = 200, 100.0
t = np.arange(n) / fs
x = np.round(np.sin(2 * np.pi * 3 * t) + 0.3 * rng.standard_normal(n) + 2 + t, 6)
y = np.round(np.roll(x, 3) + 0.5 * rng.standard_normal(n), 6)
cases = []
for order, btype, edges in [(4, "band", [1.0, 12.0]), (3, "band", [5.0, 9.0]), (2, "low", [10.0]), (5, "low", [20.0]), (3, "high", [2.0]), (1, "high", [4.0])]:
    sos = signal.butter(order, edges if btype == "band" else edges[0], btype, fs=fs, output="sos")
    cases.append(dict(order=order, btype=btype, edges=edges, out=signal.sosfiltfilt(sos, x).tolist()))
pxy = signal.csd(x, y, fs=fs, nperseg=64)[1]
out = dict(x=x.tolist(), y=y.tolist(), sosfiltfilt=cases, welch_x=signal.welch(x, fs=fs, nperseg=64)[1].tolist(),
           csd_re=pxy.real.tolist(), csd_im=pxy.imag.tolist(), coherence=signal.coherence(x, y, fs=fs, nperseg=64)[1].tolist())
json.dump(out, open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "scipy_series.json"), "w"), indent=None)
