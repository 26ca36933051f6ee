"""Records of other programs: Parquet by pyarrow, MDF4 by asammdf.

    python read_records.py FILE...

A `.csv` is written as Parquet and MDF4 to the same folder. A `.parquet` is read. Prints one JSON object with a key for
each file. Exit code 77 if a package is missing.
"""
import csv
import json
import os
import sys

try:
    import asammdf
    import numpy as np
    import pyarrow
    import pyarrow.parquet
except Exception as e:  # missing, or incompatible versions
    print(f"absent: {e}")
    sys.exit(77)


def unit_of(name):
    return {"a": "m/s2", "f": "N"}.get(name.partition("_")[0] if "_" in name else "", "µm/m")


def write(path):
    with open(path, newline="") as f:
        rows = list(csv.reader(f))
    columns = np.array(rows[1:], dtype=float).T
    time, names = columns[0], rows[0][1:]
    stem = os.path.splitext(path)[0]
    pyarrow.parquet.write_table(pyarrow.table(dict(zip(rows[0], columns))), stem + ".parquet")
    # Milliseconds as a timestamp, 32-bit reals, a text column and zstd.
    odd = {"time": pyarrow.array((time * 1000).round().astype("int64"), pyarrow.timestamp("ms"))}
    odd.update({name: pyarrow.array(v, pyarrow.float32()) for name, v in zip(names, columns[1:])})
    odd["remark"] = pyarrow.array(["dry"] * len(time))
    pyarrow.parquet.write_table(pyarrow.table(odd), stem + "_odd.parquet", compression="zstd", row_group_size=1000)
    for version, tail in (("4.10", ""), ("4.11", "_packed")):
        mdf = asammdf.MDF(version=version)
        signals = [asammdf.Signal(v, time, name=name, unit=unit_of(name)) for name, v in zip(names, columns[1:])]
        remark = asammdf.Signal(np.array([b"dry"] * len(time)), time, name="remark", encoding="utf-8")
        mdf.append([*signals, remark])
        # An additional slower group.
        mdf.append([asammdf.Signal(np.arange(5.0), np.arange(5.0), name="battery", unit="V")])
        mdf.save(stem + tail + ".mf4", overwrite=True, compression=2 if tail else 0)
    return stem


def table(path):
    read = pyarrow.parquet.read_table(path)
    return {
        "columns": {name: read[name].to_pylist() for name in read.column_names},
        "notes": {k.decode(): v.decode() for k, v in (read.schema.metadata or {}).items()},
    }


readers = {".csv": write, ".parquet": table}
print(json.dumps({os.path.basename(path): readers[os.path.splitext(path)[1]](path) for path in sys.argv[1:]}))
