"""The loaded state of a whole drive by this program and by CalculiX on the job of `swgpar export
--format inp`.

Both programs have the same mesh and load. CalculiX has facets in place of the exact cam and flanks:
more facets on the flanks show what they change.
"""

from __future__ import annotations

import argparse
import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from page import markdown, write_results
from peer import timed
from peer_ccx import read_fields
from scipy.spatial import cKDTree

import swgpar
from swgpar.design.drive_design import DriveDesign
from swgpar.exchange.calculix_growth import initial_temperature, temperatures
from swgpar.exchange.calculix_model import JobModel
from swgpar.geometry.rotation import rotated
from swgpar.meshing import MeshRecipe, load_recipe

DESIGN, RECIPE = "tests/data/small.toml", "tests/data/tiny.toml"

LOADED = (
    "steps.rotation=0",
    "output.fields=true",
    "output.figures=false",
    "output.root_stress=false",
)
"""Of the runs that are compared: all increments of the rotation are left out."""

PLANE = (
    "drive.model=plane",
    "load.torque=0.2",
    *(f"micro_geometry.{k}=0" for k in ("wg_crowning", "wg_slope")),
)
PLANE += ("micro_geometry.fs_crowning=0",)

CLAMPED = ("cup.attachment=clamped", "cup.clamping_radius=10")
"""A hub of the cup, from the bore of 6 mm on."""

BOLTED = (
    "cup.attachment=bolted",
    "cup.bolts=8",
    "cup.bolt_circle=20",
    "cup.washer_diameter=3",
)

CARRIED = (
    "output_bearing.radial_stiffness=2e4",
    "output_bearing.axial_stiffness=1e4",
    "output_bearing.tilting_stiffness=2e3",
    "output_bearing.position=20",
    "output_bearing.radial_force=20",
    "output_bearing.radial_direction=30",
)
"""The output on a bearing little stiffer than the teeth, behind the closed end, and a force."""

TILTED = (
    "output_bearing.axial_force=20",
    "output_bearing.tilting_moment=1",
    "output_bearing.tilting_direction=70",
)

HEATED = (
    "material.expansion=12e-6",
    "flexible_spline.temperature=100",
    "wave_generator.temperature=120",
    "ring_gear.temperature=60",
    "ring_gear.frame.interference=0.01",
)
"""The flexible spline grows by 19 µm of radius, the cam by 23 µm; the frame presses the ring gear,
which grows by 11 µm of radius."""


@dataclass(frozen=True)
class Case:
    """overrides : of the design;  tooth : elements of both gears;  wall : elements of the cup's
    wall;  width : elements along the face width"""

    overrides: tuple[str, ...]
    tooth: dict[str, int]
    wall: dict[str, int] = field(default_factory=dict)
    width: int = 2


CASES = {
    "plane, flank 2": Case(PLANE, {"flank": 2}),
    "plane, flank 6": Case(PLANE, {"flank": 6}),
    "plane, flank 8, root 4, rim 2": Case(PLANE, {"flank": 8, "root": 4, "rim": 2}),
    "plane, flank 6, spline fixed": Case((*PLANE, "drive.layout=spline_fixed"), {"flank": 6}),
    "plane, flank 6, heated": Case((*PLANE, *HEATED), {"flank": 6}),
    "plane, flank 6, on a bearing": Case((*PLANE, *CARRIED), {"flank": 6}),
    "plane, flank 6, spline fixed, on a bearing": Case(
        (*PLANE, *CARRIED, "drive.layout=spline_fixed"), {"flank": 6}
    ),
    "cup, flank 2": Case((), {"flank": 2}),
    "cup, flank 2, clamped": Case(CLAMPED, {"flank": 2}),
    "cup, flank 2, clamped, heated": Case((*CLAMPED, *HEATED), {"flank": 2}),
    "cup, flank 2, bolted": Case(BOLTED, {"flank": 2}, {"closed_end": 4}),
    "cup, flank 2, bolted, on a bearing": Case(
        (*BOLTED, *CARRIED, *TILTED), {"flank": 2}, {"closed_end": 4}
    ),
    "cup, flank 2, bolted, on a bearing, width 6": Case(
        (*BOLTED, *CARRIED, *TILTED), {"flank": 2}, {"closed_end": 4}, 6
    ),
    "cup, flank 2, finer wall": Case(
        (), {"flank": 2}, {"cylinder": 4, "fillet": 2, "closed_end": 4}
    ),
}

BOTH = ("rotation_deg", "cam_torque_Nmm", "flank_torque_Nmm", "fs_s1_MPa", "fs_vm_MPa")
"""Columns of both programs: the torques are those on the flexible spline."""

COLUMNS = (
    "case",
    "elements",
    *(f"{program}_{name}" for name in BOTH for program in ("swgpar", "ccx")),
)
COLUMNS += ("ccx_fs_s1_same_displacement_MPa", "displacement_difference_mm", "vm_rms_difference")
COLUMNS += ("ccx_increments", "ccx_iterations")

HEAD = (
    "case",
    "elements",
    "rotation, deg: swgpar",
    "CalculiX",
    "cam torque, N·mm: swgpar",
    "CalculiX",
)
HEAD += (
    "flank torque, N·mm: swgpar",
    "CalculiX",
    "s1, MPa: swgpar",
    "CalculiX",
    "vm, MPa: swgpar",
    "CalculiX",
)
HEAD += ("s1 of CalculiX from the displacements of swgpar",)
HEAD += ("largest difference of displacement besides the rotation, mm", "mean difference of vm")
HEAD += ("CalculiX: increments", "iterations")


def recipe_of(case: Case) -> MeshRecipe:
    """The smallest recipe with the elements of the case."""
    recipe = load_recipe(RECIPE)
    parts = {"flexible_spline": case.tooth, "ring_gear": case.tooth, "cup": case.wall}
    parts["face_width"] = {"elements": case.width}
    return recipe.model_copy(
        update={k: getattr(recipe, k).model_copy(update=v) for k, v in parts.items()}
    )


def read_prints(path: Path) -> tuple[float, dict[str, float]]:
    """Rotation (rad) of the output, and moments (N mm) about z by slave surface, the last that
    drive.dat has."""
    lines = path.read_text(encoding="ascii").splitlines()
    rotation, moments = np.nan, {}
    for k, line in enumerate(lines):
        if line.startswith(" displacements") and "set OUTPUT" in line:
            rotation = float(lines[k + 3].split()[3])
        elif line.startswith(" statistics for slave set"):
            moments[line.split()[4].rstrip(",")] = float(lines[k + 4].split()[5])
    return rotation, moments


def compare(name: str, out: Path, cores: int) -> dict[str, object]:
    """A row of the table."""
    case = CASES[name]
    folder = out / name.replace(", ", "_").replace(" ", "_")
    shutil.rmtree(folder, ignore_errors=True)
    design, recipe = swgpar.load_design(DESIGN, [*case.overrides, *LOADED]), recipe_of(case)
    if not isinstance(design, DriveDesign):
        raise TypeError(DESIGN)
    swgpar.run(design, recipe, folder / "run")
    swgpar.export(design, folder, ["inp"], mesh=recipe)
    calculix("drive", folder, cores)
    result = swgpar.open_result(folder / "run")
    model = JobModel(design, recipe)
    points, n = model.points, model.n_spline
    u, stress = read_fields(folder / "drive.frd", len(points))
    s1, vm = principal(stress[:n])
    grid = result.grid(body="flexible_spline", whole=True)
    distance, ours = cKDTree(grid.points).query(points[:n])
    if distance.max() > 1e-5:
        raise ValueError(
            f"{folder}: a node of the mesh is {distance.max():.2g} mm from those of the result"
        )
    rotation, moments = read_prints(folder / "drive.dat")
    last = {key: float(values[-1]) for key, values in result.history.items()}
    off = points[:n] + u[:n]
    off[:, :2] = rotated(off[:, :2], np.radians(last["output_angle_deg"]) - rotation)
    off -= points[:n] + np.asarray(grid.point_data["displacement"])[ours]
    reference = np.asarray(grid.point_data["vm"], dtype=float)[ours]
    prescribe(folder, np.asarray(grid.point_data["displacement"], dtype=float)[ours], model)
    calculix("elements", folder, cores)
    _, prescribed = read_fields(folder / "elements.frd", len(points))
    cam = moments.pop("FLEXIBLE_SPLINE_INNER")
    rows = [line.split() for line in (folder / "drive.sta").read_text().splitlines()[2:]]
    return {
        "case": name,
        "elements": result.summary.elements,
        "swgpar_rotation_deg": last["output_angle_deg"],
        "ccx_rotation_deg": float(np.degrees(rotation)),
        "swgpar_cam_torque_Nmm": last["wg_torque_Nmm"],
        "ccx_cam_torque_Nmm": cam,
        "swgpar_flank_torque_Nmm": last["tooth_torque_Nmm"],
        "ccx_flank_torque_Nmm": sum(moments.values()),
        "swgpar_fs_s1_MPa": last["fs_s1"],
        "ccx_fs_s1_MPa": float(s1.max()),
        "swgpar_fs_vm_MPa": last["fs_vm"],
        "ccx_fs_vm_MPa": float(vm.max()),
        "ccx_fs_s1_same_displacement_MPa": float(principal(prescribed[:n])[0].max()),
        "displacement_difference_mm": float(np.linalg.norm(off, axis=1).max()),
        "vm_rms_difference": float(np.sqrt(np.mean((vm - reference) ** 2)) / reference.max()),
        "ccx_increments": len(rows),
        "ccx_iterations": sum(int(row[3]) for row in rows),
    }


def calculix(job: str, folder: Path, cores: int) -> None:
    """Run a job of CalculiX to its end."""
    log = folder / f"{job}.log"
    timed(["ccx", job], folder, log, {"OMP_NUM_THREADS": str(cores), "OPENBLAS_NUM_THREADS": "1"})
    if "Job finished" not in log.read_text():
        raise RuntimeError(f"CalculiX failed: see {log}")


def principal(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First principal and von Mises stress (n,) of stresses (n, 6) xx yy zz xy yz zx."""
    first, second, third = np.linalg.eigvalsh(stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]).T
    return third, np.sqrt(
        0.5 * ((first - second) ** 2 + (second - third) ** 2 + (third - first) ** 2)
    )


def prescribe(folder: Path, u: np.ndarray, model: JobModel) -> None:
    """``elements.inp``: all nodes of the spline have the displacements u (n, 3) mm, the others
    none."""
    job = ["*INCLUDE, INPUT=drive_mesh.inp", "*NSET, NSET=OTHERS, GENERATE"]
    job += [f"{len(u) + 1}, {len(model.points)}", *initial_temperature(model)]
    job += ["*BOUNDARY", "OTHERS, 1, 3", "*STEP, NLGEOM", "*STATIC", "1., 1."]
    job += [*temperatures(model), "*BOUNDARY"]
    job += [f"{k + 1}, {i + 1}, {i + 1}, {u[k, i]:.12e}" for k in range(len(u)) for i in range(3)]
    job += ["*NODE FILE", "U", "*EL FILE", "S", "*END STEP"]
    (folder / "elements.inp").write_text("\n".join(job) + "\n", encoding="ascii")


def line_of(row: dict[str, object]) -> list[str]:
    """The cells of a row."""
    forms = {"elements": ",", "displacement_difference_mm": ".2g", "vm_rms_difference": ".2%"}
    forms["ccx_fs_s1_same_displacement_MPa"] = ".4g"
    forms |= {f"{program}_{name}": ".4g" for name in BOTH for program in ("swgpar", "ccx")}
    forms |= {f"{program}_rotation_deg": ".4f" for program in ("swgpar", "ccx")}
    return [format(row[name], forms.get(name, "")) for name in COLUMNS]


def main() -> None:
    """Compare the cases that are named, and write the table."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--cases", nargs="+", default=list(CASES), choices=list(CASES))
    options.add_argument(
        "--out", type=Path, default=Path("results/bench/peer_drive"), help="jobs, runs and logs"
    )
    options.add_argument("--cores", type=int, default=2, help="threads of CalculiX")
    options.add_argument("--no-page", action="store_true", help="leave docs/verification as it is")
    arguments = options.parse_args()
    if shutil.which("ccx") is None:
        options.error("CalculiX (ccx) is not installed: on Debian apt-get install calculix-ccx")
    out = arguments.out.resolve()
    kept = out / "rows.json"
    rows = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    for name in arguments.cases:
        rows[name] = compare(name, out, arguments.cores)
        kept.write_text(json.dumps(rows, indent=1), encoding="utf-8")
        print(" | ".join(line_of(rows[name])), flush=True)
    if not arguments.no_page:
        found = [rows[name] for name in CASES if name in rows]
        write_results(
            "peer_drive", COLUMNS, found, markdown([HEAD, *map(line_of, found)]), page="peer"
        )


if __name__ == "__main__":
    main()
