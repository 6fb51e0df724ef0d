"""The Python interface: what the command line, drivers and notebooks call. The names are those of
`import swgpar`.

Under mpirun every rank calls the same functions with the same arguments; results are the same on
all ranks. An error of swgpar is raised on all ranks. Any other error of one rank leaves the others
waiting: `mpirun -n 2 python -m mpi4py script.py` ends all ranks then.
"""

from swgpar.api.designs import check, mesh, new, new_train
from swgpar.api.ratings import rate
from swgpar.api.runs import export, load_design, load_mesh, open_result, run, save_report
from swgpar.api.session import Session

__all__ = [
    "Session",
    "check",
    "export",
    "load_design",
    "load_mesh",
    "mesh",
    "new",
    "new_train",
    "open_result",
    "rate",
    "run",
    "save_report",
]
