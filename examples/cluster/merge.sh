#!/bin/bash
# The fleet from all parts: sbatch --dependency=afterok:<id of the array> merge.sh JOB OUT
#SBATCH --job-name=fleet-merge
#SBATCH --cpus-per-task=1
#SBATCH --mem=2G
set -eu
here=${SLURM_SUBMIT_DIR:-$(dirname "$0")}
exec "${PYTHON:-python}" "$here/shard.py" "$1" "$2" merge
