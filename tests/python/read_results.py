"""Reads results.op2 with pyNastran and results.vtu with meshio, and prints one JSON object. Exit code 77 if a package is
missing.

    python read_results.py FOLDER
"""
import json
import sys

try:
    import meshio
    import numpy as np
    from pyNastran.op2.op2 import OP2
except Exception as e:  # missing, or incompatible versions
    print(f"absent: {e}")
    sys.exit(77)

folder = sys.argv[1]
op2 = OP2(debug=False, log=None)
op2.read_op2(f"{folder}/results.op2", build_dataframe=False)
strain = op2.op2_results.strain
cases = {}
for subcase, table in strain.cquad4_strain.items():
    cases.setdefault(str(subcase), {})["quads"] = [
        [int(e), int(n)] + [float(v) for v in row[:4]] for (e, n), row in zip(table.element_node, table.data[0])
    ]
for subcase, table in strain.ctria3_strain.items():
    cases.setdefault(str(subcase), {})["trias"] = [
        [int(e), 0] + [float(v) for v in row[:4]] for (e, _), row in zip(table.element_node, table.data[0])
    ]
for subcase, table in op2.displacements.items():
    cases.setdefault(str(subcase), {})["displacements"] = [
        [int(g)] + [float(v) for v in row] for (g, _), row in zip(table.node_gridtype, table.data[0])
    ]
mesh = meshio.read(f"{folder}/results.vtu")


def values(array):
    """Returns rows, or plain numbers if there is one component."""
    array = np.asarray(array)
    return (array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array).tolist()


vtu = {
    "points": mesh.points.tolist(),
    "cells": {block.type: int(len(block.data)) for block in mesh.cells},
    "point_data": {name: values(v) for name, v in mesh.point_data.items()},
    "cell_data": {name: [values(part) for part in v] for name, v in mesh.cell_data.items()},
}
print(json.dumps({"op2": cases, "vtu": vtu}))
