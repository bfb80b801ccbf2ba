#!/usr/bin/env bash
# One piece of a picture, as a task of a Slurm array. The arguments are those of vdbtrace:
#   sbatch --parsable --array=0-15 picture.sh part.gcode -o part.png
# A task that was killed and requeued keeps its part if it was finished. docs/many_machines.md has the merge.
#SBATCH --job-name=vdbtrace --requeue --cpus-per-task=4
exec "${STRATUM_BIN:+$STRATUM_BIN/}vdbtrace" "$@" --shard slurm --shard-by tiles --resume --quiet \
  --threads "${SLURM_CPUS_PER_TASK:-1}"
