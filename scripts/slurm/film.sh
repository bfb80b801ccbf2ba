#!/usr/bin/env bash
# A chunk of the pictures of a film, as a task of a Slurm array. The arguments are those of vdbtrace:
#   sbatch --array=0-7 film.sh part.gcode -o film/part.png --progress-series 240
# A task that was killed and requeued goes on with the pictures that it has not finished.
#SBATCH --job-name=vdbtrace --requeue --cpus-per-task=4
exec "${STRATUM_BIN:+$STRATUM_BIN/}vdbtrace" "$@" --shard slurm --shard-by frames --resume --quiet \
  --threads "${SLURM_CPUS_PER_TASK:-1}"
