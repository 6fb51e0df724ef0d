"""The rooms of the package in the order of the data, and what each is for.

A module imports only from its own room and from those before it; `tests/unit/test_layering.py`
reads the order here.
"""

from __future__ import annotations

PURPOSE = {
    "rooms": "this order",
    "version": "version of the package",
    "errors": "exceptions of one sentence, with exit codes",
    "whole_files": "files that get their names together",
    "watch": "signals that end a command, and its signs of life",
    "log": "log of rank 0, progress, wall seconds by phase",
    "petsc": "start of PETSc and its options",
    "tasks": "tasks shared by the ranks",
    "input": "quantities with units and ranges, TOML files, sentences that refuse bad values",
    "materials": "laws of materials: what bodies are made of",
    "geometry": "exact cams, walls and rims, crowning and slope, from numbers",
    "profiles": "exact tooth profiles, from numbers, and how rigid teeth move past each other",
    "meshing": "mesh recipes, tooth sectors, quality, interpolation between meshes, export",
    "design": "design file of the drive: sections and derived quantities",
    "load": "load states, stages and programs: what is applied, in which order",
    "checks": "what judges a design: fit of keys, clearance, remarks; starter designs",
    "kernel": "C++ kernels of elements, contact and friction, and their Cython layer",
    "fem": "distribution over ranks, element assembly, condensed parts, sectors in reach, stress",
    "contact": "contact of cam, pins and flanks: search, enforcement, friction",
    "constraints": "supports and distributing couplings",
    "solve": "residual and tangent, Newton's method, linear systems",
    "model": "the drive as bodies, contacts, supports and solver",
    "results": "history, tables, fields and checkpoints in a results folder, for every system",
    "run_options": "what a run is asked for beside its design",
    "answers": "numbers that a run gives, with units, errors and places",
    "flank_pressure": "pressure where flanks touch: lines and patches of pairs of teeth",
    "largest_stress": "largest stresses of bodies: places, and finer meshes that resolve them",
    "evaluation": "what follows from computed states: one typed result for each question",
    "drive_results": "the table of answers and the result of a drive, in memory or from files",
    "analysis": "a run: starts, load stepping, mesh refinement, recording, restart",
    "presentation": "what a person sees of a drive: figures, report, terminal, view",
    "exchange": "files of other programs: STEP, DXF, VTKHDF, tables of histories, look-up tables, "
    "FMU",
    "vibration": "meshes with backlash, elastic rings, statistical linearisation, random samples",
    "gear_trains": "lumped models of gear trains around strain wave gears",
    "systems": "registry of what can be computed, drives and gear trains, for the interfaces and "
    "studies",
    "studies": "many runs: cases, schedule, tables, report",
    "rating": "rating sheet of a drive: the runs that it needs, verdicts, views",
    "optimisation": "search for the best design: variables, objectives, constraints, report",
    "api": "the Python interface",
    "app": "a drive in the browser: form, section of the teeth, plane state, queue of jobs",
    "cli": "the command line",
}
"""Purpose of each room, in the order of the rooms."""

ROOMS = tuple(PURPOSE)
