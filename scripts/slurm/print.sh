#!/usr/bin/env bash
# One share of a print's level set, as a task of a Slurm array. The arguments are those of gcode2vdb:
#   sbatch --parsable --array=0-15 print.sh part.gcode -o part.vdb --voxel-size 0.05
# A task that was killed and requeued keeps its part if it was finished. docs/many_machines.md has the merge.
#SBATCH --job-name=gcode2vdb --requeue --cpus-per-task=4
exec "${STRATUM_BIN:+$STRATUM_BIN/}gcode2vdb" "$@" --shard slurm --resume --quiet --threads "${SLURM_CPUS_PER_TASK:-1}"
