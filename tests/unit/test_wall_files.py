"""The wall of a cup from CSV and DXF files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import swgpar
from support.cup_shapes import CONTOUR, Changes, cone, shaped
from swgpar.errors import InputError
from swgpar.exchange.dxf import write_dxf
from swgpar.exchange.points import write_points
from swgpar.input.corner_file import Corner, read_corners
from swgpar.input.toml_file import to_toml

STEP: Changes = {
    "contour": [
        {"distance": 2.0, "thickness": 0.48},
        {"distance": 5.0, "thickness": 0.36, "rounding": 4.0},
    ]
}
"""A straight inner surface."""


@pytest.mark.parametrize("changes", [cone(79.0, rounding=0.5), CONTOUR, STEP])
def test_there_and_back(changes: Changes, tmp_path: Path) -> None:
    """Export and import of wall.dxf, and of its tables: the same surfaces."""
    case = shaped(changes)
    path = write_dxf(case, tmp_path)[-1]
    assert path.name == "wall.dxf"
    files = {
        f"{side}_{key}": value
        for side in ("inner", "outer")
        for key, value in (("file", str(path)), ("layer", side))
    }
    again = shaped({**changes, "contour": None, **files})
    s = np.linspace(0.0, case.cup_sizes.wall_length, 801)
    for side in ("inner", "outer"):
        lines = [getattr(each.cup_sizes.wall, side) for each in (case, again)]
        assert lines[1].radius(s) == pytest.approx(lines[0].radius(s), abs=1e-9)
        assert len(lines[1].arcs()) == len(lines[0].arcs())
    # the design needs no file any more
    assert again.cup.inner_file is None and again.cup.contour
    write_points(case, tmp_path)
    tables = {f"{side}_file": str(tmp_path / f"wall_{side}.csv") for side in ("inner", "outer")}
    by_table = shaped({**changes, "contour": None, **tables})
    for one, other in zip(by_table.cup_sizes.points, again.cup_sizes.points, strict=True):
        assert tuple(one) == pytest.approx(tuple(other), abs=1e-8)


def test_corners_of_csv_files(tmp_path: Path) -> None:
    inner, outer = tmp_path / "inner.csv", tmp_path / "outer.csv"
    inner.write_text("distance,radius\n10,18.6\n0,18.6\n", encoding="utf-8")
    outer.write_text("0,19.08\n2,19.08\n5,18.96\n10,18.96\n", encoding="utf-8")
    assert read_corners(inner) == [Corner(0.0, 18.6, 0.0), Corner(10.0, 18.6, 0.0)]
    case = shaped({"inner_file": str(inner), "outer_file": str(outer)})
    points = case.cup_sizes.points
    assert [p.distance for p in points] == pytest.approx([0.0, 2.0, 5.0, 10.0])
    assert [p.outer_radius - p.radius for p in points] == pytest.approx([0.48, 0.48, 0.36, 0.36])


def test_paths_are_relative_to_the_design_file(tmp_path: Path) -> None:
    (tmp_path / "in.csv").write_text("4,18.6\n10,18.6\n", encoding="utf-8")
    (tmp_path / "out.csv").write_text("4,19.08\n10,19.0\n", encoding="utf-8")
    table = shaped({}).model_dump(mode="json", exclude_none=True)
    table["cup"] |= {"inner_file": "in.csv", "outer_file": "out.csv", "contour": []}
    path = tmp_path / "drive.toml"
    path.write_text(to_toml(table), encoding="utf-8")
    assert len(swgpar.load_design(path).cup.contour) == 2


def test_what_is_no_wall_is_refused(tmp_path: Path) -> None:
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    one.write_text("2,18.6\n5,18.5\n10,18.5\n", encoding="utf-8")
    two.write_text("2,19.08\n10,18.4\n", encoding="utf-8")
    with pytest.raises(InputError, match="cup.contour.3"):
        shaped({"inner_file": str(one), "outer_file": str(two)})
    with pytest.raises(InputError, match="cup.inner_file and cup.outer_file belong together"):
        shaped({"inner_file": str(one)})
    with pytest.raises(InputError, match="belong together"):
        shaped({**STEP, "inner_file": str(one), "outer_file": str(two)})


def test_arcs_that_round_no_corner_are_refused(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    space.add_line((0.0, 10.0), (4.0, 10.0))
    space.add_arc((4.0, 12.0), 2.0, 290.0, 330.0)
    document.saveas(tmp_path / "wall.dxf")
    with pytest.raises(InputError, match="more than one curve"):
        read_corners(tmp_path / "wall.dxf")
    space.delete_entity(list(space)[1])
    space.add_arc((4.0, 12.0), 2.0, 270.0, 330.0)
    document.saveas(tmp_path / "wall.dxf")
    with pytest.raises(InputError, match="not tangent to a straight line on both sides"):
        read_corners(tmp_path / "wall.dxf")
    space.add_circle((0.0, 0.0), 1.0)
    document.saveas(tmp_path / "wall.dxf")
    with pytest.raises(InputError, match="kind CIRCLE"):
        read_corners(tmp_path / "wall.dxf")
