#!/usr/bin/env bash
# swgpar on a Slurm cluster: sbatch scripts/hpc/slurm.sh DESIGN RECIPE OUT [further arguments of swgpar run]
#SBATCH --job-name=swgpar
#SBATCH --nodes=1
#SBATCH --ntasks-per-node=16
#SBATCH --cpus-per-task=1
#SBATCH --mem=64G
#SBATCH --time=04:00:00
#SBATCH --requeue
set -euo pipefail
cd "$SLURM_SUBMIT_DIR"
# load your site's MPI and PETSc here, for example: module load openmpi petsc
source .venv/bin/activate
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1  # one BLAS thread per rank
design=$1 recipe=$2 out=$3
shift 3
# a job that was requeued goes on from its last increment
if [[ -f $out/checkpoint.h5 ]]; then set -- --restart "$@"; fi
srun swgpar run "$design" --mesh "$recipe" --out "$out" "$@"
