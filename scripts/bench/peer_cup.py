"""The deflected, loaded flexible spline of the cup drive by CalculiX, on the mesh of this program's
run.

The run gives the displacements of the nodes on which forces act: those of surface faces with a
contact pressure, and the bore, which is held. In CalculiX these nodes get the same displacements in
one increment with finite rotations. All other nodes, in the teeth, the rim, the wall and the closed
end, carry no load: both programs find their equilibrium from the same data (`peer_cup_swgpar.py`).
Seconds are those of the whole commands.
"""

from __future__ import annotations

import argparse
import csv
import json
import shutil
import sys
from pathlib import Path

import numpy as np
from page import markdown, put
from peer import timed
from peer_ccx import read_answer
from scipy.spatial import cKDTree

import swgpar
from swgpar.design.drive_design import DriveDesign
from swgpar.meshing import build_sector_meshes, load_recipe
from swgpar.meshing.export import named_nodes, whole_body, whole_drive
from swgpar.meshing.inp import write_inp
from swgpar.meshing.sector import SectorMesh

DESIGN, BODY = "drivers/cup_45deg.toml", "flexible_spline"

LOADED = ["steps.rotation=0", "output.root_stress=false", "output.figures=false"]

HEAD = (
    "mesh",
    "dofs",
    "prescribed nodes",
    "largest displacement, mm",
    "largest difference elsewhere",
)
HEAD += (
    "its share",
    "s1, MPa: swgpar",
    "CalculiX",
    "iterations",
    "seconds: swgpar",
    "CalculiX",
    "times faster",
)

THREADS = {"OPENBLAS_NUM_THREADS": "1"}


def mesh_argument(name: str) -> str:
    """The recipe for a command that runs in another folder."""
    return str(Path(name).resolve()) if name.endswith(".toml") else name


def run(name: str, folder: Path, ranks: int) -> None:
    """Run the drive up to the load."""
    command = [
        "mpirun",
        "-n",
        str(ranks),
        "swgpar",
        "run",
        str(Path(DESIGN).resolve()),
        "--mesh",
        mesh_argument(name),
    ]
    command += ["--set", *LOADED, "--out", str(folder / "run"), "--overwrite"]
    timed(command, folder, folder / "swgpar.log", {"OMP_NUM_THREADS": "1", **THREADS})


def solve(
    name: str, nodes: np.ndarray, u: np.ndarray, folder: Path, ranks: int
) -> tuple[float, int]:
    """The spline alone by this program; returns wall seconds and Newton iterations."""
    np.savez(folder / "held.npz", nodes=nodes, displacement=u[nodes])
    program = Path(__file__).with_name("peer_cup_swgpar.py")
    command = [
        "mpirun",
        "-n",
        str(ranks),
        sys.executable,
        str(program),
        name,
        str(folder / "held.npz"),
        str(folder),
    ]
    seconds = timed(
        command, Path.cwd(), folder / "spline.log", {"OMP_NUM_THREADS": "1", **THREADS}
    ).seconds
    return seconds, int(
        json.loads((folder / "spline.json").read_text(encoding="utf-8"))["iterations"]
    )


def fields(folder: Path, coords: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement (n, 3) mm, s1 and contact pressure (n,) MPa of the run at the nodes (n, 3) of
    the whole spline."""
    grid = swgpar.open_result(folder / "run").grid(body=BODY, whole=True)
    distance, nearest = cKDTree(grid.points).query(coords)
    if distance.max() > 1e-4:
        raise ValueError(
            f"{folder}: a node of the mesh is {distance.max():.2g} mm from those of the result"
        )
    return tuple(
        np.asarray(grid.point_data[name], dtype=float)[nearest]
        for name in ("displacement", "s1", "pressure")
    )


def held(mesh: SectorMesh, elements: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Nodes whose displacements are prescribed: elements under pressure have all of their nodes on
    surfaces there."""
    touching = elements[(pressure[elements] > 0.0).any(axis=1)]
    names = named_nodes(mesh)
    on_surface = np.unique(
        np.concatenate([names[f"{BODY}_{name}"] for name in ("flanks", "inner")])
    )
    return np.union1d(np.intersect1d(np.unique(touching), on_surface), names[f"{BODY}_bore"])


def write_job(
    design: DriveDesign, mesh: SectorMesh, nodes: np.ndarray, u: np.ndarray, folder: Path
) -> None:
    """``spline.inp``, the mesh, and ``job.inp``, which names it and prescribes the displacements u
    (n, 3) mm."""
    write_inp(
        folder / "spline.inp",
        whole_drive({BODY: mesh}),
        {},
        {BODY: design.materials[BODY]},
        design.drive.face_width,
    )
    job = [
        "*INCLUDE, INPUT=spline.inp",
        "*STEP, NLGEOM, INC=1000",
        "*STATIC",
        "1., 1.",
        "*BOUNDARY",
    ]
    job += [f"{n + 1}, {k + 1}, {k + 1}, {u[n, k]:.12e}" for n in nodes for k in range(3)]
    job += ["*NODE FILE, FREQUENCY=1000", "U", "*EL FILE, FREQUENCY=1000", "S", "*END STEP"]
    (folder / "job.inp").write_text("\n".join(job) + "\n", encoding="ascii")


def compare(name: str, out: Path, cores: int) -> list[str]:
    """A row of the table."""
    folder = out / Path(name).stem
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    design = swgpar.load_design(Path(DESIGN), LOADED)
    mesh = build_sector_meshes(design.geometry, load_recipe(name))[BODY]
    coords, elements = whole_body(mesh)
    run(name, folder, cores)
    u, s1, pressure = fields(folder, coords)
    nodes = held(mesh, elements, pressure)
    write_job(design, mesh, nodes, u, folder)
    seconds, iterations = solve(name, nodes, u, folder, cores)
    theirs = timed(
        ["ccx", "job"], folder, folder / "ccx.log", {"OMP_NUM_THREADS": str(cores), **THREADS}
    ).seconds
    answer = read_answer(folder, len(coords))
    largest = np.linalg.norm(u, axis=1).max()
    free = np.setdiff1d(np.arange(len(coords)), nodes)
    difference = np.linalg.norm(u - answer.displacement, axis=1)[free].max()
    top = free[s1[free].argmax()]
    cells = [
        Path(name).stem,
        f"{coords.size:,}",
        f"{len(nodes):,}",
        f"{largest:.4f}",
        f"{difference:.2g}",
    ]
    cells += [
        f"{difference / largest:.3%}",
        f"{s1[top]:.1f}",
        f"{answer.s1[top]:.1f}",
        f"{iterations} / {answer.iterations}",
    ]
    return [*cells, f"{seconds:.1f}", f"{theirs:.0f}", f"{theirs / seconds:.2g}"]


def main() -> None:
    """Compare on every mesh that is named, and write the table."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument(
        "--meshes",
        nargs="+",
        default=["coarse", "medium", "scripts/bench/peer_cup.toml"],
        help="recipes",
    )
    options.add_argument(
        "--out", type=Path, default=Path("results/bench/peer_cup"), help="jobs and logs"
    )
    options.add_argument(
        "--cores", type=int, default=2, help="threads of CalculiX, ranks of this program"
    )
    arguments = options.parse_args()
    if shutil.which("ccx") is None:
        options.error("CalculiX (ccx) is not installed: on Debian apt-get install calculix-ccx")
    rows = [compare(name, arguments.out.resolve(), arguments.cores) for name in arguments.meshes]
    with Path("docs/verification/data/peer_cup.csv").open(
        "w", newline="", encoding="utf-8"
    ) as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])
    put(Path("docs/verification/peer.md"), "cup", markdown([HEAD, *rows]))
    for row in rows:
        print(" | ".join(row))


if __name__ == "__main__":
    main()
