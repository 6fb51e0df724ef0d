"""Arrays that do not fit a kernel are refused in a sentence before the kernel reads or writes past
them.

Every function is called with valid arguments, in which one array at a time is replaced by wrong
ones. These are made from the valid array, so that an argument or a field of a record that is added
is tried as well.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from support.contact_blocks import Rows, master
from support.element_mesh import ElementMesh
from swgpar.contact.flank_pairs import Faces
from swgpar.gear_trains.kernel import MESH, MESH_ERROR, SHAFT, GearboxKernel, PlanetaryStepKernel
from swgpar.kernel import (
    add_contact_lines,
    add_face_blocks,
    add_line_compliances,
    assemble_elements,
    contact_flanks,
    recover_stress,
    reference_elements,
)
from swgpar.materials import Isotropic
from swgpar.watch import _watch

Values = dict[str, Any]

OTHER_TYPE = {"f": np.float32, "i": np.float64, "u": np.int32, "V": np.float64}
"""A wrong type for arrays of each kind."""

N_BLOCKS = 112
"""Pairs of nodes that two hexahedra with a common face have."""

N_OWN = 6
"""Rows of the tangent, fewer than nodes."""


@dataclass(frozen=True)
class Call:
    """A function with its valid arguments; arrays are found in the arguments and in the fields of
    records.

    written : arrays that the kernel changes;  optional : arrays that may be None
    indices : the values from the first to below the second that an array of indices may have
    free : axes on which no other argument depends: more entries are valid there
    converted : arrays that may be lists, of another type or in another order
    """

    name: str
    function: Callable[..., Any]
    arguments: Callable[[], Values]
    written: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    indices: dict[str, tuple[int, int]] = field(default_factory=dict)
    free: tuple[tuple[str, int], ...] = ()
    converted: tuple[str, ...] = ()


def flank() -> Values:
    """One face pressed into a flat flank of 3 x 4 nodes, with friction and a tangent; 4 + 12
    nodes."""
    x, z = np.linspace(-0.4, 0.4, 3), np.linspace(-0.5, 0.5, 4)
    points = np.column_stack([x, np.zeros(3)])
    corners = np.array([[-0.15, 0.0, -0.2], [0.15, 0.0, -0.2], [0.15, 0.0, 0.2], [-0.15, 0.0, 0.2]])
    faces = Faces(
        np.arange(4, dtype=np.int32)[None],
        np.zeros((1, 4), np.uint8),
        corners[None].copy(),
        np.array([[0.0, -1.0, 0.0]]),
        np.full((1, 2, 4), 0.25),
        np.full((1, 2), 0.1),
        np.zeros((1, 2)),
        np.zeros(1, np.int32),
    )
    u = np.zeros((16, 3))
    u[:4, 1] = -0.01
    friction = SimpleNamespace(
        coefficient=0.1,
        stiffness=np.full((1, 2), 1e3),
        foot_point=np.zeros((1, 2, 2)),
        gap=np.zeros((1, 2)),
        traction=np.zeros((1, 2, 2)),
        current=np.zeros((1, 2, 2)),
        lagged=np.ones((1, 2)),
    )
    return {
        "patches": master(points, np.tile([1.0, 0.0], (3, 1)), x - x[0], z, 4),
        "faces": faces,
        "u": u,
        "multiplier": np.zeros((1, 2)),
        "penalty": 1e3,
        "opening": 0.0,
        "reach": 1.0,
        "limit": np.inf,
        "residual": np.zeros((16, 3)),
        "rows": Rows(N_OWN, n_local=16),
        "friction": friction,
        "rotation": 0.0,
        "moment": np.zeros(1),
        "beyond": 1e-4,
        "gradients": SimpleNamespace(
            conn=np.zeros((1, 2, 8), np.int32),
            sixths=np.zeros((1, 2, 8), np.uint8),
            vector=np.zeros((1, 2, 8, 3)),
            friction=np.zeros((1, 2, 8, 3)),
        ),
    }


def face_blocks() -> Values:
    return {
        "conn": np.array([[0, 1, 8]], dtype=np.int32),
        "sixths": np.zeros((1, 3), np.uint8),
        "blocks": np.ones((1, 3, 3, 3, 3)),
        "rows": Rows(N_OWN, n_local=9),
    }


def contact_lines() -> Values:
    """Two lines, of two cells and of one, whose gaps depend on three nodes each."""
    return {
        "start": np.array([0, 2, 3]),
        "conn": np.array([[0, 1, 8], [1, 2, -1], [3, 4, 8]], dtype=np.int32),
        "sixths": np.zeros((3, 3), np.uint8),
        "left": np.ones((3, 3, 3)),
        "right": np.ones((3, 3, 3)),
        "stiffness": np.ones(5),
        "rows": Rows(N_OWN, n_local=9),
    }


def line_compliances() -> Values:
    """Two lines, of two cells and of one, on a flank of three nodes."""
    return {
        "start": np.array([0, 2, 3]),
        "low": np.array([0.1, 0.3, 0.7]),
        "high": np.array([0.3, 0.5, 0.8]),
        "missing": SimpleNamespace(
            s=np.array([0.0, 0.5, 1.0]), green=np.zeros((3, 3)), logarithm=1e-5
        ),
        "out": np.zeros(5),
    }


def box() -> ElementMesh:
    """Two hexahedra along z."""
    points = np.array(
        [[x, y, z] for z in (0.0, 1.0, 2.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
        dtype=float,
    )
    return ElementMesh(points, np.array([np.arange(8), np.arange(4, 12)]), Isotropic(E=1.0, nu=0.3))


def undeformed() -> Values:
    return {"coords": box().reference.coords, "elasticity": np.eye(6)}


def elements(*more: str) -> Values:
    """more : fields of the reference elements that a function reads beside those that all read"""
    mesh = box()
    ref_of, rotation, conn, sixths = mesh.arrays
    read = {
        name: getattr(mesh.reference, name)
        for name in ("stiffness", "gradient", "coords", "stress_free", *more)
    }
    return {
        "ref": SimpleNamespace(**read),
        "ref_of": ref_of,
        "rotation": rotation,
        "conn": conn,
        "sixths": sixths,
        "u": np.zeros((12, 3)),
    }


def assembly() -> Values:
    slot = np.ascontiguousarray(box().slot)
    tangent = {"slot": slot, "values": np.zeros((slot.max() + 1, 3, 3))}
    return elements() | {"residual": np.zeros((12, 3))} | tangent


def recovery() -> Values:
    return elements("recovery")


def gearbox() -> Values:
    meshes, shafts = np.ones(18, MESH), np.ones(11, SHAFT)
    return {
        "mass": np.ones(23),
        "meshes": meshes,
        "shafts": shafts,
        "contact_ramp": 1.0,
        "generator_damping": 0.0,
        "braked": False,
    }


def motion() -> Values:
    return {"errors": np.zeros(18, MESH_ERROR), "x": np.zeros(23), "v": np.zeros(23)}


def steps() -> Values:
    """Three steps of a train with 4 modes and 2 meshes."""
    return {
        "h": 1e-3,
        "half_backlash": 0.0,
        "from_q": np.zeros(4),
        "from_y": np.zeros(4),
        "from_torque": np.zeros(4),
        "from_force": np.zeros(4),
        "deflection_rows": np.zeros((4, 2, 4)),
        "compliance": np.zeros((4, 2, 2)),
        "damping": np.zeros(2),
    }


def advance() -> Values:
    return {
        "first": 0,
        "q": np.zeros((4, 5)),
        "y": np.zeros((4, 5)),
        "mesh_term": np.zeros((4, 5)),
        "torques": np.zeros((3, 5)),
        "solve": np.zeros((3, 2, 2)),
        "stiffness": np.zeros((3, 2)),
        "constant": np.zeros((3, 2)),
        "flanks": np.ones(2),
    }


def of_gearbox(method: str) -> Callable[..., Any]:
    return lambda **values: getattr(GearboxKernel(**gearbox()), method)(**values)


def torques() -> Values:
    return {"x": np.zeros((3, 23)), "v": np.zeros((3, 23))}


def simulation() -> Values:
    return motion() | {"rack_force": np.zeros(2), "h": 1e-3}


CALLS = [
    Call(
        "contact_flanks",
        contact_flanks,
        flank,
        (
            "residual",
            "moment",
            "rows.values",
            "friction.current",
            "gradients.conn",
            "gradients.sixths",
            "gradients.vector",
            "gradients.friction",
        ),
        ("residual", "moment", "rows", "friction", "friction.lagged", "gradients"),
        {
            "patches.conn": (-1, 16),
            "patches.sixths": (0, 6),
            "faces.conn": (-1, 16),
            "faces.sixths": (0, 6),
            "faces.patch": (0, 1),
        },
    ),
    Call(
        "add_face_blocks",
        add_face_blocks,
        face_blocks,
        ("rows.values",),
        indices={"conn": (-1, 9), "sixths": (0, 6)},
        free=(("rows.number", 0),),
    ),
    Call(
        "add_contact_lines",
        add_contact_lines,
        contact_lines,
        ("rows.values",),
        indices={"conn": (-1, 9), "sixths": (0, 6)},
        free=(("rows.number", 0), ("start", 0)),  # a line may have no cells
    ),
    Call(
        "add_line_compliances",
        add_line_compliances,
        line_compliances,
        ("out",),
        free=(("start", 0),),
    ),
    Call(
        "reference_elements",
        reference_elements,
        undeformed,
        free=(("coords", 0),),
        converted=("coords", "elasticity"),
    ),
    Call(
        "assemble_elements",
        assemble_elements,
        assembly,
        ("residual", "values"),
        ("residual", "values"),
        {"conn": (-1, 12), "sixths": (0, 6), "ref_of": (0, 2), "slot": (-1, N_BLOCKS)},
        (("u", 0), ("values", 0)),
    ),
    Call(
        "recover_stress",
        recover_stress,
        recovery,
        indices={"conn": (-1, 12), "sixths": (0, 6), "ref_of": (0, 2)},
        free=(("u", 0),),
    ),
    Call("GearboxKernel", GearboxKernel, gearbox),
    Call("GearboxKernel.forces", of_gearbox("forces"), motion),
    Call("GearboxKernel.matrices", of_gearbox("matrices"), motion),
    Call("GearboxKernel.torques", of_gearbox("torques"), torques),
    Call(
        "GearboxKernel.simulate",
        of_gearbox("simulate"),
        simulation,
        ("x", "v"),
        free=(("rack_force", 0),),
    ),
    Call("PlanetaryStepKernel", PlanetaryStepKernel, steps),
    Call(
        "PlanetaryStepKernel.advance",
        lambda **values: PlanetaryStepKernel(**steps()).advance(**values),
        advance,
        ("q", "y", "mesh_term"),
        ("flanks",),
    ),
]


def paths(values: Values) -> Iterator[tuple[str, np.ndarray]]:
    """The arrays among arguments, and in those that are records, as `argument` or
    `argument.field`."""
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            yield name, value
        elif hasattr(value, "__dict__"):
            yield from (
                (f"{name}.{key}", array)
                for key, array in vars(value).items()
                if isinstance(array, np.ndarray)
            )


def replaced(values: Values, path: str, array: object) -> Values:
    """The arguments with another array."""
    name, _, attribute = path.partition(".")
    if not attribute:
        return values | {name: array}
    record = copy.copy(values[name])
    setattr(record, attribute, array)
    return values | {name: record}


def wrong_arrays(call: Call, path: str, array: np.ndarray) -> Iterator[tuple[str, object]]:
    """What is tried instead of a valid array, with its name."""
    if path not in call.optional:
        yield "none", None
    if path not in call.converted:
        yield "list", array.tolist()
        yield "type", np.zeros(array.shape, OTHER_TYPE[array.dtype.kind])
    yield "more dimensions", array[None]
    yield "fewer dimensions", array[..., 0].copy()
    for axis in [
        axis for axis in range(array.ndim) if array.shape[axis] > 1 and path not in call.converted
    ][-1:]:
        yield "order", np.repeat(array, 2, axis)[(slice(None),) * axis + (slice(None, None, 2),)]
    for axis in range(array.ndim):
        if (path, axis) not in call.free or path not in call.converted:
            yield f"axis {axis} too small", np.ascontiguousarray(np.delete(array, -1, axis))
        if (path, axis) not in call.free:
            yield (
                f"axis {axis} too large",
                np.concatenate([array, np.take(array, [-1], axis)], axis),
            )
    if path in call.written:
        fixed = array.copy()
        fixed.flags.writeable = False
        yield "read-only", fixed
    low, end = call.indices.get(path, (0, 0))
    for value in [
        v for v in (low - 1, end) if path in call.indices and v >= (-1 if low == 0 else end)
    ]:
        if np.can_cast(np.min_scalar_type(value), array.dtype) or array.dtype.kind == "i":
            other = array.copy()
            other.flat[-1] = value
            yield f"index {value}", other


CASES = [
    pytest.param(call, path, array, id=f"{call.name}-{path}-{kind}")
    for call in CALLS
    for path, valid in paths(call.arguments())
    for kind, array in wrong_arrays(call, path, valid)
]


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.name)
def test_the_arguments_are_valid(call: Call) -> None:
    call.function(**call.arguments())
    for name in call.optional:
        call.function(**replaced(call.arguments(), name, None))


@pytest.mark.parametrize(("call", "path", "array"), CASES)
def test_a_wrong_array_is_refused(call: Call, path: str, array: object) -> None:
    """In a sentence with the function, an argument, what it is and what is expected."""
    with pytest.raises(ValueError, match=rf"^{re.escape(call.name)}: [\w.\[\]']+ .*; expected "):
        call.function(**replaced(call.arguments(), path, array))


def test_the_message() -> None:
    values = flank() | {"residual": np.zeros((15, 3))}
    sentence = "contact_flanks: residual is float64 (15, 3); expected float64 (16, 3), C-ordered"
    with pytest.raises(ValueError, match=f"^{re.escape(sentence)}$"):
        contact_flanks(**values)


@pytest.mark.parametrize("starts", [[0, 5, 3, 21], [1, 6, 11, 21], [0, 6, 11, 22]])
def test_rows_lie_within_their_blocks(starts: list[int]) -> None:
    values = face_blocks()
    values["rows"].start[[0, 1, 2, -1]] = starts
    with pytest.raises(
        ValueError,
        match=r"^add_face_blocks: rows.start .*; expected to ascend from 0 to the 21 blocks",
    ):
        add_face_blocks(**values)


@pytest.mark.parametrize("start", [[0, 4, 3], [1, 2, 3], [0, 2, 2], [0, -1, 3]])
@pytest.mark.parametrize(
    ("function", "arguments"),
    [(add_contact_lines, contact_lines), (add_line_compliances, line_compliances)],
    ids=["add_contact_lines", "add_line_compliances"],
)
def test_lines_have_all_cells(
    function: Callable[..., Any], arguments: Callable[[], Values], start: list[int]
) -> None:
    with pytest.raises(
        ValueError,
        match=rf"^{function.__name__}: start .*; expected to ascend from 0 to the 3 cells",
    ):
        function(**arguments() | {"start": np.array(start)})


@pytest.mark.parametrize("n_own", [-1, 10])
def test_no_more_rows_than_nodes(n_own: int) -> None:
    values = face_blocks()
    values["rows"].n_own = n_own
    with pytest.raises(
        ValueError,
        match=r"^add_face_blocks: rows.n_own is .*; expected from 0 to the 9 local nodes",
    ):
        add_face_blocks(**values)


@pytest.mark.parametrize("field", ["driver", "driven"])
@pytest.mark.parametrize("gear", [-1, 23])
def test_meshes_join_gears_of_the_gearbox(field: str, gear: int) -> None:
    values = gearbox()
    values["meshes"][field][3] = gear
    with pytest.raises(
        ValueError, match=rf"^GearboxKernel: meshes\['{field}'\] .*; expected from 0 to below 23"
    ):
        GearboxKernel(**values)


@pytest.mark.parametrize("first", [-1, 1, 2**63 - 1])
def test_steps_are_those_of_the_train(first: int) -> None:
    with pytest.raises(
        ValueError, match=r"^PlanetaryStepKernel.advance: torques .*; expected a state and steps"
    ):
        PlanetaryStepKernel(**steps()).advance(**advance() | {"first": first})


def test_a_mesh_too_many() -> None:
    values = steps() | {
        "deflection_rows": np.zeros((4, 25, 4)),
        "compliance": np.zeros((4, 25, 25)),
    }
    with pytest.raises(
        ValueError, match=r"^PlanetaryStepKernel: deflection_rows .*; expected from 1 to 24 meshes"
    ):
        PlanetaryStepKernel(**values | {"damping": np.zeros(25)})


def test_texts_and_intervals_of_the_watch() -> None:
    for call in (lambda: _watch.set_sign_of_life(None), lambda: _watch.set_sentence(b"", None)):
        with pytest.raises(TypeError):
            call()
    for interval in (0.0, -1.0, float("nan")):
        with pytest.raises(
            ValueError, match=r"^start_heart: interval is .*; expected seconds above 0"
        ):
            _watch.start_heart(interval)
