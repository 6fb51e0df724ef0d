"""What holds and loads the gears in a job of CalculiX: couplings, flange, guide, and bearing of the
output."""

from __future__ import annotations

from collections.abc import Iterator

from swgpar.exchange.calculix_flange import Flange
from swgpar.exchange.calculix_growth import grown_frame
from swgpar.exchange.calculix_model import JobModel, Term


class JobSupports:
    """Two nodes of the output, and where the flexible spline stands still two for it: three
    displacements and three rotations each. Two more for the guide of an output on a bearing.

    model : the drive;  first_node, first_element : numbers from 1 from which they are free

    Attributes:
    equations : that give a displacement by others, dependent ones first
    fixed : boundary conditions of all steps beside those of the output and of a frame that grows
    frame : displacements by a frame that grows;  held : what holds gears but for the rotation of
    the output
    output_held : those of them that hold the output
    turn : node and degree of freedom of that rotation
    """

    def __init__(self, model: JobModel, first_node: int, first_element: int) -> None:
        self.model, design = model, model.design
        self.ring_fixed = design.kinematics.standing_gear == "ring_gear"
        self.bearing = design.output_bearing
        self._first, self._first_element = first_node, first_element
        self.flange = None
        if design.has_attachment:
            self.flange = Flange(model, first_node + 6, first_element)
        self.surface = (
            model.surface(model.spline, "bore")
            if self.ring_fixed
            else model.surface(model.ring, "outer")
        )
        self.equations = [*self._equations()]
        self.frame, self.fixed = grown_frame(model), ["ALL_NODES, 3, 3"] if model.plane else []
        if self.ring_fixed and not self.frame:
            self.fixed.append(f"RING_GEAR_OUTER, 1, {2 if model.plane else 3}")
        self._freedoms = [(first_node, axis) for axis in (1, 2, 3)]
        self._freedoms += [(first_node + 1, axis) for axis in (1, 2)]
        self.turn = f"{first_node + 1}, 3"
        self.output_held = [f"{first_node}, 1, 3", f"{first_node + 1}, 1, 2"]
        if self.bearing:
            moves = 2 if model.plane else len(self._freedoms)
            self._freedoms, stands = self._freedoms[:moves], self._freedoms[moves:]
            self.output_held = [f"{node}, {axis}, {axis}" for node, axis in stands]
        self.held = list(self.output_held)
        if not self.ring_fixed:
            self.held += [f"{first_node + k}, 1, 3" for k in (2, 3)]

    def _equations(self) -> Iterator[list[Term]]:
        """Of the couplings without a flange, and of the guide."""
        model, output = self.model, self._first - 1
        place = self.bearing.position if self.bearing else None
        if not self.ring_fixed:
            guide = output + 4 if self.bearing else None
            yield from model.mean_motion(
                self.surface, output, place=place, in_housing=True, guide=guide
            )
            yield from model.housing(self.surface.nodes, guide)
        if self.flange is None and self.ring_fixed:
            yield from model.mean_motion(self.surface, output, place=place)
        elif self.flange is None:
            yield from model.mean_motion(model.surface(model.spline, "bore"), output + 2)

    def lines(self) -> Iterator[str]:
        """Nodes, flange and springs."""
        middle = self.flange.middle if self.flange else 0.0
        place = self.bearing.position if self.bearing else None
        places = {"OUTPUT": middle if place is None else place}
        if not self.ring_fixed:
            places["SPLINE"] = middle
            if self.bearing:
                places["GUIDE"] = 0.0
        for k, (name, z) in enumerate(places.items()):
            yield f"*NODE, NSET={name}"
            node = self._first + 2 * k
            yield from (f"{node}, 0., 0., {z:.12e}", f"{node + 1}, 0., 0., {z:.12e}")
        element = self._first_element
        if self.flange:
            yield from self.flange.lines(self._first + (0 if self.ring_fixed else 2))
            element = self.flange.next_element
        if self.bearing:
            springs = zip(self._freedoms, self.bearing.stiffness, strict=False)
            for k, ((node, axis), stiffness) in enumerate(springs):
                name = f"OUTPUT_BEARING_{k + 1}"
                yield from (f"*ELEMENT, TYPE=SPRING1, ELSET={name}", f"{element + k}, {node}")
                yield from (f"*SPRING, ELSET={name}", str(axis), f"{stiffness:.12e}")

    def loads(self) -> Iterator[str]:
        """The torque, and the forces on the output."""
        design = self.model.design
        torque = design.kinematics.internal_torque(design.load.torque)
        yield "*CLOAD"
        if self.ring_fixed and self.flange:
            yield f"{self.turn}, {torque:.12e}"
        else:
            yield from self._torque(torque)
        if self.bearing:
            forces = zip(self._freedoms, self.bearing.load, strict=False)
            yield from (f"{node}, {axis}, {force:.12e}" for (node, axis), force in forces if force)

    def _torque(self, torque: float) -> Iterator[str]:
        """Forces of the torque (N mm): those of the distributing coupling at the angle zero of the
        output."""
        nodes, weight = self.surface.nodes, self.surface.weight
        x = self.model.points[nodes, :2]
        share = torque * weight / float((weight * (x**2).sum(axis=1)).sum())
        for node, fx, fy in zip(nodes + 1, -share * x[:, 1], share * x[:, 0], strict=True):
            yield from (f"{node}, 1, {fx:.12e}", f"{node}, 2, {fy:.12e}")
