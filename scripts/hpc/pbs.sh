#!/usr/bin/env bash
# swgpar on a PBS cluster: qsub -v DESIGN=drivers/cup_45deg.toml,RECIPE=full,OUT=results/full scripts/hpc/pbs.sh
#PBS -N swgpar
#PBS -l select=1:ncpus=16:mpiprocs=16:ompthreads=1:mem=64gb
#PBS -l walltime=04:00:00
#PBS -r y
set -euo pipefail
cd "$PBS_O_WORKDIR"
# load your site's MPI and PETSc here, for example: module load openmpi petsc
source .venv/bin/activate
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1  # one BLAS thread per rank
restart=()
if [[ -f $OUT/checkpoint.h5 ]]; then restart=(--restart); fi
mpirun swgpar run "$DESIGN" --mesh "$RECIPE" --out "$OUT" "${restart[@]}"
