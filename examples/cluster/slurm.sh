#!/bin/bash
# A fleet as a SLURM array: sbatch slurm.sh JOB OUT LIST. Then, once all parts are done: sbatch --dependency=afterok:<id> merge.sh JOB OUT.
# JOB, OUT and the records have the same paths on every node. A part that is repeated processes new records only.
#SBATCH --job-name=fleet
#SBATCH --array=1-4
#SBATCH --cpus-per-task=2
#SBATCH --mem=2G
#SBATCH --time=04:00:00
#SBATCH --requeue
set -eu
here=${SLURM_SUBMIT_DIR:-$(dirname "$0")}
python=${PYTHON:-python}
exec "$python" "$here/shard.py" "$1" "$2" "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" "$3"
