"""Writes one record in the formats of loggers and their programs.

These are TDMS by npTDMS, universal files by pyuff, MDF4 by asammdf, and Parquet, Feather and CSV by pandas.

    python write_loggers.py FOLDER

Prints one JSON object: the samples, and the written files. Exit code 77 if a package is missing.
"""
import json
import os
import sys

try:
    import asammdf
    import nptdms
    import numpy as np
    import pandas
    import pyarrow  # noqa: F401  (pandas writes Parquet and Feather with it)
    import pyuff
except Exception as e:  # missing, or incompatible versions
    print(f"absent: {e}")
    sys.exit(77)

folder = sys.argv[1]
N, DT, UNIT = 70_000, 0.002, "um/m"
t = np.arange(N) * DT
columns = {
    "P01": 100 * np.sin(3 * t) + 0.1 * (np.arange(N) % 7),
    "P02": -50 * np.cos(5 * t),
    "P03": np.floor(200 * np.sin(t)),
}


def path(name):
    return os.path.join(folder, name)


def tdms(name, scaled):
    waveform = {"wf_increment": DT, "wf_start_offset": 0.0, "wf_samples": 1, "unit_string": UNIT}
    with nptdms.TdmsWriter(path(name)) as writer:
        # Segments of different length, as a logger writes them.
        for begin, end in [(0, 1000), (1000, 2000), (2000, 40_001), (40_001, N)]:
            objects = [nptdms.RootObject(properties={"title": "a day"}), nptdms.GroupObject("strain")]
            for k, (key, v) in enumerate(columns.items()):
                properties = dict(waveform)
                data = v[begin:end]
                if scaled and k == 1:
                    data = np.round(data * 100).astype("int16")
                    properties.update({
                        "NI_Number_Of_Scales": 1,
                        "NI_Scaling_Status": "unscaled",
                        "NI_Scale[0]_Scale_Type": "Linear",
                        "NI_Scale[0]_Linear_Slope": 0.01,
                        "NI_Scale[0]_Linear_Y_Intercept": 0.0,
                        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
                    })
                elif scaled:
                    data = data.astype("float32")
                objects.append(nptdms.ChannelObject("strain", key, data, properties=properties))
            # An additional slow channel and a text.
            objects.append(nptdms.ChannelObject("slow", "battery", np.arange(3.0), properties={"wf_increment": 1.0}))
            objects.append(nptdms.ChannelObject("notes", "remark", ["dry"]))
            writer.write_segment(objects)


def uff(name, binary):
    if os.path.exists(path(name)):
        os.remove(path(name))
    file = pyuff.UFF(path(name))
    for k, (key, v) in enumerate(columns.items()):
        data = {
            "type": 58, "binary": int(binary), "func_type": 1, "rsp_node": k + 1, "rsp_dir": 3, "ref_node": 0, "ref_dir": 0,
            "data": v, "x": t, "id1": key, "rsp_ent_name": "strain", "abscissa_spacing": 1, "abscissa_spec_data_type": 17,
            "ordinate_spec_data_type": 3, "orddenom_spec_data_type": 0, "ordinate_axis_units_lab": UNIT, "ord_data_type": 4,
        }
        file.write_sets(data, "add")


def mdf(name, groups, compression, raw=False):
    file = asammdf.MDF(version="4.10")
    signals = [asammdf.Signal(v, t, name=key, unit=UNIT) for key, v in columns.items()]
    if raw:
        linear = asammdf.blocks.conversion_utils.from_dict({"a": 0.01, "b": 0.0})
        counts = np.round(columns["P02"] * 100).astype("int16")
        signals[1] = asammdf.Signal(counts, t, name="P02", unit=UNIT, conversion=linear, raw=True)
    if groups:
        for s in signals:
            file.append([s])
    else:
        file.append(signals)
    file.append([asammdf.Signal(np.arange(5.0), np.arange(5.0), name="battery", unit="V")])
    file.save(path(name), overwrite=True, compression=compression)


tdms("plain.tdms", False)
tdms("scaled.tdms", True)
uff("text.uff", False)
uff("binary.uff", True)
mdf("together.mf4", False, 0)
mdf("apart.mf4", True, 0)
mdf("deflated.mf4", False, 1)
mdf("transposed.mf4", True, 2)
mdf("counts.mf4", False, 2, raw=True)
named = pandas.DataFrame({f"{k} [{UNIT}]": v for k, v in columns.items()})
dated = named.set_index(pandas.Timestamp("2026-05-01 12:00:00") + pandas.to_timedelta(t, unit="s"))
dated.to_parquet(path("dated.parquet"), row_group_size=10_000)
dated.to_csv(path("dated.csv"))
timed = named.copy()
timed.insert(0, "Time [s]", t.round(3))
timed.to_parquet(path("timed.parquet"), index=False, compression="zstd")
timed.to_parquet(path("lz4.parquet"), index=False, compression="lz4")
timed.to_parquet(path("brotli.parquet"), index=False, compression="brotli")
timed.to_feather(path("lz4.feather"))
timed.to_feather(path("zstd.feather"), compression="zstd")
timed.to_feather(path("plain.feather"), compression="uncompressed")
dated.reset_index().to_feather(path("dated.feather"))
half = timed.astype({name: "float16" for name in named})
half.to_parquet(path("half.parquet"), index=False)
timed.to_csv(path("timed.csv"), quoting=1)
timed.to_csv(path("utf16.csv"), sep=";", decimal=",", encoding="utf-16", index=False)
files = sorted(f for f in os.listdir(folder) if f.rsplit(".", 1)[-1] in ("tdms", "uff", "mf4", "parquet", "feather", "csv"))
print(json.dumps({"columns": {k: v.tolist() for k, v in columns.items()}, "files": files}))
