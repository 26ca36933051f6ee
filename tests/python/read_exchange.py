"""Reads the files of place and recover: XLSX with openpyxl, VTU with meshio, RPC III with rpc3-file, bulk data with
pyNastran.

    python read_exchange.py FILE...

Prints one JSON object with a key for each file. Exit code 77 if a package is missing. A `.csv` is converted to RPC III
(`.rsp` in the same folder, with reals if its name ends in `_real`).
"""
import csv
import json
import os
import sys

try:
    import meshio
    import numpy as np
    import openpyxl
    import rpc3
    from pyNastran.bdf.bdf import read_bdf
except Exception as e:  # missing, or incompatible versions
    print(f"absent: {e}")
    sys.exit(77)

rpc3.rpc3.progressbar = False


def xlsx(path):
    book = openpyxl.load_workbook(path)
    return {sheet.title: [list(row) for row in sheet.iter_rows(values_only=True)] for sheet in book}


def vtu(path):
    mesh = meshio.read(path)
    return {
        "points": mesh.points.tolist(),
        "cells": {block.type: len(block.data) for block in mesh.cells},
        "point_data": {name: np.asarray(v).reshape(len(mesh.points), -1).tolist() for name, v in mesh.point_data.items()},
    }


def rsp(path):
    channels, params = rpc3.read(path, strip=False)
    return {
        "samples": params["SAMPLES"],
        "channels": [{"name": c.name, "unit": c.unit, "dt": c.dt, "step": c.resolution, "data": np.asarray(c.data, float).tolist()} for c in channels],
    }


def bdf(path):
    model = read_bdf(path, xref=False, punch=True, debug=None)
    return {
        "forces": {str(sid): [[c.type, c.node, c.mag, list(map(float, c.xyz))] for c in cards] for sid, cards in model.loads.items()},
        "combinations": {
            str(sid): [[float(c.scale), list(map(float, c.scale_factors)), list(c.load_ids)] for c in cards]
            for sid, cards in model.load_combinations.items()
        },
        "tloads": {str(sid): [[c.excite_id, c.tid] for c in cards] for sid, cards in model.dload_entries.items()},
        "dloads": {str(sid): [[list(map(float, c.scale_factors)), list(c.load_ids)] for c in cards] for sid, cards in model.dloads.items()},
        "tables": {str(tid): [t.x.tolist(), t.y.tolist()] for tid, t in model.tables_d.items()},
    }


def unit_of(name, strain):
    return {"a": "m/s2", "f": "N"}.get(name.partition("_")[0] if "_" in name else "", strain)


def to_rpc(path):
    with open(path, newline="") as f:
        rows = list(csv.reader(f))
    columns = np.array(rows[1:], dtype=float).T
    dt = columns[0][1] - columns[0][0]
    channels = [rpc3.Channel(name, unit_of(name, "uE"), dt=dt, data=v) for name, v in zip(rows[0][1:], columns[1:])]
    target = os.path.splitext(path)[0] + ".rsp"
    rpc3.write(target, channels, datatype=float if "_real" in path else int, overwrite=True)
    return target


readers = {".xlsx": xlsx, ".vtu": vtu, ".rsp": rsp, ".bdf": bdf, ".csv": to_rpc}
print(json.dumps({os.path.basename(path): readers[os.path.splitext(path)[1]](path) for path in sys.argv[1:]}))
