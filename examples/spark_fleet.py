"""A fleet on Spark: every task takes some paths, does them with the Python package, and yields a row a file.

    spark-submit examples/spark_fleet.py JOB.toml OUT FILE...

The package is installed where the executors run (`pip install .`). Job, records and OUT must be reachable under the same paths by every executor.
What a task did is kept in OUT/days, so a task that Spark repeats costs nothing; the driver merges at the end. Prints how many files are done,
failed and second copies.
"""

import collections
import sys

import pyarrow as pa
from pyspark.sql import SparkSession

from strainbridge import fleet


def main(job: str, out: str, files: list[str]) -> None:
    def task(batches):
        for batch in batches:
            done = fleet.part(job, batch.column("path").to_pylist(), out, threads=1)
            columns = {k: [f[k] for f in done] for k in ("path", "status", "message")}
            yield pa.RecordBatch.from_pydict(columns, schema=pa.schema([(k, pa.string()) for k in columns]))

    spark = SparkSession.builder.appName("strainbridge fleet").getOrCreate()
    paths = spark.createDataFrame([(f,) for f in files], "path string")
    tasks = max(1, len(files) // fleet.FILES_A_TASK)
    rows = paths.repartition(tasks).mapInArrow(task, "path string, status string, message string").collect()
    result = fleet.run(job, [r.path for r in rows], out)
    print(dict(collections.Counter(f["status"] for f in result["files"])))
    spark.stop()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
