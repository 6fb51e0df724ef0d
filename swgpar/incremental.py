"""The run: increments with prediction and cut-back, backlash, histories."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from swgpar.assembly import Elements
from swgpar.condensed import bend, condense
from swgpar.contact.rigid import RigidContact
from swgpar.contact.search import largest
from swgpar.contact.teeth import ToothContact
from swgpar.couplings import Coupling, Housing
from swgpar.design import DriveDesign
from swgpar.discrete_drive import near
from swgpar.equilibrium import Equilibrium
from swgpar.errors import ConvergenceError
from swgpar.holding import Holding
from swgpar.kernel import reference_elements
from swgpar.log import Phases, logger
from swgpar.meshing import MeshRecipe, build_sector_meshes
from swgpar.micro_geometry import WaveGeneratorSurface
from swgpar.partition import BodyLayout, LocalNodes, Partition
from swgpar.prediction import State, predict
from swgpar.steps import Scene, start
from swgpar.stress import body_fields, maxima
from swgpar.torques import torques

LOADED = 3
"""Step from which states repeat with the period."""

MEMORY = 40
"""States of the rotation that are kept to predict the next ones from."""

CLOSING = 10
"""Turns in which a backlash is closed: each leaves some eighth of it, by the pressure angle."""

PRESSURE_LIMIT = 0.02
"""Bound of contact pressures in the tangent's geometric terms, as a share of E: above any real pressure."""


def halved(design: DriveDesign) -> bool:
    """Whether the drive equals itself turned by 180 degrees and the design lets the model use it."""
    even = design.drive.teeth_fs % 2 == 0 and design.drive.teeth_rg % 2 == 0
    return design.solver.twofold_symmetry and even


class DriveModel:
    """Everything that exists once per run: meshes, ownership, equilibrium.

    Parameters
    ----------
    design, recipe : the drive and how it is meshed
    comm : communicator
    """

    def __init__(self, design: DriveDesign, recipe: MeshRecipe, comm: MPI.Comm) -> None:
        self.design, self.comm, self.phases = design, comm, Phases()
        images = halved(design)
        with self.phases("mesh"):
            self.meshes = build_sector_meshes(design, recipe)
        layouts, references = [], []
        for name, mesh in self.meshes.items():
            with self.phases("elements"):
                coords = mesh.coords[mesh.elements]
                reference = reference_elements(coords, design.material.E, design.material.nu, design.drive.face_width)
                condensed = condense(mesh, reference) if design.solver.condensed_sectors else None
            references.append(reference)
            clamped = name == "ring_gear" and design.drive.layout == "ring_fixed"
            fixed = mesh.node_sets["outer"] if clamped else np.zeros(0, dtype=np.int32)
            count = mesh.n_sectors // 2 if images else mesh.n_sectors
            layouts.append(BodyLayout(mesh, 0, count, True, images, fixed, condensed))
        self.partition = Partition(layouts, comm)
        with self.phases("elements"):
            self.elements = Elements(self.partition, references, symmetric=design.contact.friction == 0.0)
            self.elements.bind(LocalNodes(self.partition, self.elements.wanted))
        spline, ring = self.elements.bodies
        surface = WaveGeneratorSurface(design)
        half_width = 0.5 * design.wave_generator.face_width * (1.0 + 1e-9)
        rigid = (
            surface,
            design.r_fs,
            half_width,
            design.contact.wg_quadrature,
            design.wg_penalty,
            np.radians(design.wave_generator.pin_half_angle),
            PRESSURE_LIMIT * design.material.E,
        )
        micro = design.micro_geometry
        teeth = ToothContact(
            self.partition,
            spline,
            ring,
            design.contact.quadrature,
            micro.fs_crowning,
            design.drive.face_width,
            micro.crowning_shape,
            design.penalty,
            max(0.5 * design.drive.module, near(design)),
            PRESSURE_LIMIT * design.material.E,
            design.contact.friction,
        )
        couplings, housing = [Coupling(self.partition, spline, "bore", images)], None
        if design.drive.layout == "spline_fixed":
            couplings.append(Coupling(self.partition, ring, "outer", images))
            outer = float(np.hypot(*couplings[-1].reference[:, :2].T).max(initial=0.0))
            area = 2.0 * np.pi * outer * design.drive.face_width / (2.0 if images else 1.0)
            housing = Housing(couplings[-1], area, design.penalty)
        scale = design.material.E * design.drive.module
        self.equilibrium = Equilibrium(
            design,
            self.partition,
            self.elements,
            Holding(self.partition, couplings, housing, scale, 0.5 if images else 1.0),
            RigidContact(spline, *rigid),
            RigidContact(spline, *rigid),
            teeth,
            self.phases,
        )
        self.copies = 2 if images else 1
        self.fixed_body = 1 if design.drive.layout == "ring_fixed" else 0

    def destroy(self) -> None:
        """Release the solver and its factor, which Python cannot: PETSc holds references in a circle. Collective."""
        self.equilibrium.destroy()

    def bend_left_out(self) -> float:
        """Stress (MPa) that condensed sectors leave out in the present state: E theta^2 / 8 where they bend most."""
        body = self.elements.bodies[0]
        if body.layout.condensed is None:
            return 0.0
        angle = body.layout.turn(body.layout.first_tooth + body.sectors[body.owned])
        turn = bend(body.layout.mesh, angle, body.displacement(self.equilibrium.displacement())[body.owned])
        return largest(self.comm, self.design.material.E * float((turn**2).max(initial=0.0)) / 8.0)

    def elements_whole(self) -> int:
        """Elements of the whole drive."""
        return sum(b["elements_whole"] for b in self.counts().values())

    def counts(self) -> dict[str, Any]:
        """Nodes, elements and unknowns per body, modelled and of the whole drive."""
        out = {}
        for layout in self.partition.layouts:
            layers = 1 if layout.mesh.tied is None else 2
            per_sector = (len(layout.mesh.coords) - len(layout.mesh.ccw_nodes)) // layers
            out[layout.name] = {
                "nodes": per_sector * layout.count,
                "elements": len(layout.mesh.hexes) * layout.count,
                "dofs": self.partition.dims * len(layout.own) * layout.count,
                "nodes_whole": per_sector * layout.mesh.n_sectors,
                "elements_whole": len(layout.mesh.hexes) * layout.mesh.n_sectors,
                "quality": layout.mesh.quality,
            }
        return out


class Runner:
    """Goes through the sequence, one increment after the other; `row` describes the state reached."""

    def __init__(self, model: DriveModel) -> None:
        self.model, self.design = model, model.design
        self.equilibrium = model.equilibrium
        self.scene = start(model.design)
        self.iterations = 0
        self.residual = 0.0
        self.visited: list[State] = []

    def reset(self) -> None:
        """Go back to the undeformed drive."""
        self.scene, self.visited = start(self.design), []
        self.equilibrium.x.set(0.0)
        self.equilibrium.resume({})

    def take(self, scene: Scene) -> None:
        """Take the model's present state as that of `scene`."""
        self.scene = scene
        self.visited = [(scene.angle, self.equilibrium.x.copy())]

    def advance(self, target: Scene) -> None:
        """Solve up to `target`, halving the way when Newton's iteration fails; raises ConvergenceError at the end."""
        origin, x = self.scene, self.equilibrium.x
        if origin.control == "rotation" and target.control == "torque":
            # cut, the way begins with the torque that holds the output
            held = self.equilibrium.holding.reactions(self.equilibrium.multipliers(x))
            origin = replace(origin, torque=float(held[-1]))
            self._close_backlash(target)
        done, share, cuts = 0.0, 1.0, 0
        while done < 1.0:
            saved = x.copy()
            reach = min(1.0, done + share)
            scene = origin.toward(target, reach, self.design.drive.module, self.design.d)
            if scene.angle != self.scene.angle:
                self._turn_to(scene.angle)
            elif scene.control == "rotation" and scene.rotation != self.scene.rotation:
                self._slip(scene.rotation - self.scene.rotation)
            elif scene.name == "deflect" and self.scene.name == "deflect":
                # the ring bends in proportion to the travel of the pins, or to the growth of the cam
                first, old, new = (s.cam if s.pins is None else s.pins for s in (start(self.design), self.scene, scene))
                x.scale((first - new) / (first - old))
            contacts = [value is not None for value in (scene.cam, scene.pins, scene.teeth)]
            before = [value is not None for value in (self.scene.cam, self.scene.pins, self.scene.teeth)]
            fresh = self.scene.step == 0 or any(new and not old for new, old in zip(contacts, before))
            solved = self.equilibrium.solve(scene, soft=fresh)
            self.iterations += solved.iterations
            if solved.converged:
                self.scene, self.residual, done = scene, solved.residual, reach
                if target.step >= LOADED:
                    self.visited = [*self.visited, (scene.angle, x.copy())][-MEMORY:]
                continue
            saved.copy(x)
            cuts += 1
            if cuts > self.design.solver.max_cutbacks or origin == target:  # nothing to halve
                raise ConvergenceError(
                    f"step {target.step} ({target.name}) did not converge at a wave-generator angle of "
                    f"{np.degrees(scene.angle):.4g} degrees after {cuts - 1} cut-backs: {solved.reason}, residual "
                    f"{solved.residual:.1e} of the contact force"
                )
            share *= 0.5
            logger.info(
                "   cut back to %.3g of the increment (%s, residual %.1e)", share, solved.reason, solved.residual
            )

    def _close_backlash(self, target: Scene) -> None:
        """Turn the output until the flanks that are to carry nearly meet.

        The drive's pattern turns along, past the cam: Newton's steps turn the spline straight ahead, which lifts it off
        the cam, so that a turn by a fraction of the backlash costs them several iterations.
        """
        for _ in range(CLOSING):
            turn = self.equilibrium.closing_turn(target)
            if turn == 0.0:
                break
            self._slip(turn)

    def _slip(self, turn: float) -> None:
        """Turn the output in its pattern (rad)."""
        x = self.equilibrium.x
        predict(self.model.partition, self.model.fixed_body, [(0.0, x)], x, 0.0, turn)

    def _turn_to(self, angle: float) -> None:
        """Predict the state at a cam angle (rad) from those visited, or from the present one."""
        x = self.equilibrium.x
        predict(self.model.partition, self.model.fixed_body, self.visited or [(self.scene.angle, x)], x, angle)

    def increment(self, target: Scene) -> None:
        """Do one entry of the sequence."""
        self.iterations = 0
        self.advance(target)

    def row(self) -> dict[str, float]:
        """The history row of the present state, without stresses and times."""
        equilibrium, copies = self.equilibrium, self.model.copies
        torque = torques(equilibrium)
        pairs = (
            self.model.comm.allreduce(equilibrium.teeth.touching_pairs(), op=MPI.SUM)
            if self.scene.teeth is not None
            else 0
        )
        return {
            "step": self.scene.step,
            "wg_angle_deg": float(np.degrees(self.scene.angle)),
            "output_angle_deg": float(np.degrees(equilibrium.rotation())),
            "wg_torque_Nmm": torque["wg"],
            "tooth_torque_Nmm": torque["teeth"],
            "output_torque_Nmm": torque["output"],
            "torque_balance_Nmm": torque["balance"],
            "pairs_in_contact": copies * pairs,
            "max_penetration_mm": equilibrium.penetration(),
            "newton_iterations": self.iterations,
        }


def stresses(model: DriveModel) -> tuple[dict[str, float], list[dict[str, np.ndarray]]]:
    """Maxima for the history and nodal fields of both bodies."""
    u = model.equilibrium.displacement()
    values, fields = {}, []
    for prefix, body in zip(("fs", "rg"), model.elements.bodies):
        field = body_fields(body, u)
        fields.append(field)
        values.update({f"{prefix}_{k}": v for k, v in maxima(model.comm, field).items()})
    return values, fields
