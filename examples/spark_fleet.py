"""Processes a fleet on Spark. Every task processes some paths with the Python package, and yields a row for each file.

    spark-submit examples/spark_fleet.py JOB.toml OUT FILE...

Install the package where the executors run (`pip install` of the wheel). Every executor must find job, records and OUT under the same paths. The
results of a task are stored in OUT/days, so that a repeated task costs no time. The driver merges at the end with the digests that the tasks return,
and reads no record. It prints the number of files that are done, failed or second copies.

On Databricks, import `fleet_on_spark` in a notebook and pass it the session `spark`.
"""

import collections
import sys

import pyarrow as pa
from pyspark.sql import SparkSession

import strainbridge as sb
from strainbridge import fleet

COLUMNS = ("path", "status", "message", "sha256")


def fleet_on_spark(spark, job: str, out: str, files: list[str]):
    """The outcome of `fleet.run`, with the files processed by the executors."""

    def task(batches):
        for batch in batches:
            paths = batch.column("path").to_pylist()
            try:
                done = fleet.part(job, paths, out, 1, mark)
            except sb.Faults as faults:
                # The fault is returned and not raised. Spark would repeat the task, with the same fault.
                done = [{"path": paths[0], "status": "fault", "message": str(faults), "sha256": ""}]
            columns = {k: [f[k] for f in done] for k in COLUMNS}
            yield pa.RecordBatch.from_pydict(columns, schema=pa.schema([(k, pa.string()) for k in columns]))

    with fleet.mark(out) as mark:
        paths = spark.createDataFrame([(f,) for f in files], "path string")
        tasks = max(1, len(files) // fleet.FILES_A_TASK)
        rows = paths.repartition(tasks).mapInArrow(task, ", ".join(f"{k} string" for k in COLUMNS)).collect()
    wrong = sorted({r.message for r in rows if r.status == "fault"})
    if wrong:
        raise fleet.FleetError("\n".join(wrong))
    return fleet.run(job, files, out, digests={r.path: r.sha256 for r in rows if r.sha256})


def main(job: str, out: str, files: list[str]) -> None:
    spark = SparkSession.builder.appName("strainbridge fleet").getOrCreate()
    result = fleet_on_spark(spark, job, out, files)
    print(dict(collections.Counter(f["status"] for f in result["files"])))
    spark.stop()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
