"""One of the peer problems by CalculiX: the job on the project's own INP file, and its results."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from peer_problems import CAM, CAM_HALF_ANGLE, PENALTY, STEEL, WIDTH, Problem, line

from swgpar.meshing import SectorMesh
from swgpar.meshing.export import named_surfaces, whole_body, whole_drive
from swgpar.meshing.inp import write_inp

CAM_FACETS = 4
"""Facets of the cam for one element around the ring: it is not exact in CalculiX, as it is here."""

CAM_DEPTH = 2.0
"""mm, thickness of the layer of elements that carries the cam's surface."""


@dataclass(frozen=True)
class Answer:
    """displacement : (n, 3) mm;  s1 : (n,) MPa

    equations : of the linear systems;  iterations : of all increments;  increments : that converged
    """

    displacement: np.ndarray
    s1: np.ndarray
    equations: int
    iterations: int
    increments: int


def rows(numbers: np.ndarray) -> list[str]:
    return [", ".join(map(str, numbers[k : k + 16])) for k in range(0, len(numbers), 16)]


def cam(facets: int, first_node: int, first_element: int) -> list[str]:
    """Both halves of the cam as a layer of elements below the ellipse, one along the axis; their
    surface is CAM."""
    a, b = CAM
    angle = np.radians(CAM_HALF_ANGLE) * np.linspace(-1.0, 1.0, facets + 1)
    lines = []
    nodes = []
    elements = []
    sets = []
    for half, sign in (("UPPER", 1.0), ("LOWER", -1.0)):
        start = first_node + len(nodes)
        outline = np.column_stack([-b * np.sin(angle), a * np.cos(angle)]) * sign
        for xy in (outline, outline * (1.0 - CAM_DEPTH / a)):
            for z in (-0.6 * WIDTH, 0.6 * WIDTH):
                nodes += [(*point, z) for point in xy]
        sets.append(f"*NSET, NSET=CAM_{half}, GENERATE\n{start}, {first_node + len(nodes) - 1}")
        n = facets + 1
        outer, inner = start + np.arange(facets), start + 2 * n + np.arange(facets)
        # outward, then counter-clockwise: a positive volume, of which S4 is the outer face
        elements += [
            (i, o, o + 1, i + 1, i + n, o + n, o + 1 + n, i + 1 + n) for i, o in zip(inner, outer)
        ]
    lines.append("*NODE")
    lines += [
        f"{first_node + k}, {x:.12e}, {y:.12e}, {z:.12e}" for k, (x, y, z) in enumerate(nodes)
    ]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=CAM")
    lines += [f"{first_element + k}, " + ", ".join(map(str, e)) for k, e in enumerate(elements)]
    lines += [
        *sets,
        "*SURFACE, NAME=CAM, TYPE=ELEMENT",
        "CAM, S4",
        "*SOLID SECTION, ELSET=CAM, MATERIAL=RING_MATERIAL",
    ]
    return lines


def write_job(problem: Problem, mesh: SectorMesh, folder: Path) -> None:
    """``ring.inp``, which is the mesh, and ``job.inp``, which names it and has supports, loads and
    the step."""
    meshes = {"ring": mesh}
    write_inp(
        folder / "ring.inp", whole_drive(meshes), named_surfaces(meshes), {mesh.body: STEEL}, WIDTH
    )
    coords, elements = whole_body(mesh)
    x, y, z = coords.T
    # the two planes of symmetry hold the ring, which moves by symmetry only
    job = ["*INCLUDE, INPUT=ring.inp"]
    job += ["*NSET, NSET=AXIS_Y", *rows(np.flatnonzero(np.abs(x) < 1e-9) + 1)]
    job += ["*NSET, NSET=AXIS_X", *rows(np.flatnonzero(np.abs(y) < 1e-9) + 1)]
    middle = np.flatnonzero((np.abs(x) < 1e-9) & (np.abs(z) < 1e-9) & (y > 0.0))[:1]
    job += ["*BOUNDARY", "AXIS_Y, 1, 1", "AXIS_X, 2, 2", f"{middle[0] + 1}, 3, 3"]
    if problem.travel:
        job += cam(
            CAM_FACETS * int(2 * mesh.n_sectors * CAM_HALF_ANGLE / 180.0),
            len(coords) + 1,
            len(elements) + 1,
        )
        job += ["*BOUNDARY"] + [
            f"CAM_{half}, {k}, {k}" for half in ("UPPER", "LOWER") for k in (1, 3)
        ]
        job += [
            "*SURFACE INTERACTION, NAME=STIFF",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        ]
        job += [
            f"{PENALTY * STEEL.E:g}",
            "*CONTACT PAIR, INTERACTION=STIFF, TYPE=SURFACE TO SURFACE",
            "RING_INNER, CAM",
        ]
    job += (
        ["*STEP", "*STATIC"] if problem.linear else ["*STEP, NLGEOM, INC=1000", "*STATIC", "1., 1."]
    )
    if problem.travel:
        job += ["*BOUNDARY"] + [
            f"CAM_{half}, 2, 2, {s * problem.travel}" for half, s in (("UPPER", 1), ("LOWER", -1))
        ]
    else:
        job.append("*CLOAD")
        for sign in (1.0, -1.0):
            nodes, share = line(coords * (1.0, sign, 1.0))
            job += [f"{n + 1}, 2, {-sign * problem.force * s:.12e}" for n, s in zip(nodes, share)]
    job += ["*NODE FILE, FREQUENCY=1000", "U", "*EL FILE, FREQUENCY=1000", "S", "*END STEP"]
    (folder / "job.inp").write_text("\n".join(job) + "\n", encoding="ascii")


def read_fields(path: Path, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (n, 3) mm and stresses (n, 6) MPa xx yy zz xy yz zx of nodes 1 to n, the last
    of the FRD file."""
    found = {}
    with path.open(encoding="ascii", errors="replace") as file:
        name, columns = "", []
        for text in file:
            if text.startswith(" -4"):
                name, columns = text.split()[1], []
            elif name in ("DISP", "STRESS"):
                if text.startswith(" -1"):
                    columns.append(text)
                elif text.startswith(" -3"):
                    found[name], name = columns, ""
    out = []
    for name, width in (("DISP", 3), ("STRESS", 6)):
        values = np.full((n, width), np.nan)
        for text in found[name]:
            node = int(text[3:13]) - 1
            if node < n:
                values[node] = [float(text[13 + 12 * k : 25 + 12 * k]) for k in range(width)]
        if np.isnan(values).any():
            raise ValueError(f"{path}: nodes without {name}")
        out.append(values)
    return out[0], out[1]


def read_answer(folder: Path, n: int) -> Answer:
    """What the finished job found at nodes 1 to n."""
    lines = (folder / "ccx.log").read_text().splitlines()
    if not any("Job finished" in text for text in lines):
        raise RuntimeError(f"CalculiX failed: see {folder / 'ccx.log'}")
    equations = int(
        lines[[k for k, text in enumerate(lines) if "number of equations" in text][-1] + 1]
    )
    displacement, s = read_fields(folder / "job.frd", n)
    tensor = s[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    iterations = sum(text.strip().startswith("iteration ") for text in lines)
    table = [text.split() for text in (folder / "job.sta").read_text().splitlines()]
    increments = sum(bool(row) and row[0].isdigit() for row in table)
    # a linear step has neither in its files
    return Answer(
        displacement,
        np.linalg.eigvalsh(tensor)[:, 2],
        equations,
        max(1, iterations),
        max(1, increments),
    )
