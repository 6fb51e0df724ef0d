"""Text of XDMF files, which describe meshes of hexahedra and nodal fields in HDF5 files.

A place is the name of a file and that of a data set in it: "mesh.h5:/body/points".
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

KINDS = {1: "Scalar", 3: "Vector", 6: "Tensor6"}
"""Of attributes, by number of components."""


def _item(place: str, size: str, precision: int = 8, kind: str = "Float") -> str:
    start = (
        f'<DataItem Format="HDF" NumberType="{kind}" Precision="{precision}" Dimensions="{size}">'
    )
    return f"{start}{place}</DataItem>"


def hexahedra(place: str, count: int) -> str:
    """Cells (count, 8) int64."""
    item = _item(place, f"{count} 8", kind="Int")
    return f'<Topology TopologyType="Hexahedron" NumberOfElements="{count}">{item}</Topology>'


def points(place: str, count: int) -> str:
    """Points (count, 3) float64."""
    return f'<Geometry GeometryType="XYZ">{_item(place, f"{count} 3")}</Geometry>'


def attribute(name: str, place: str, count: int, components: int = 1, precision: int = 8) -> str:
    """A nodal field (count,) or (count, components). precision : bytes of a number"""
    item = _item(place, f"{count}" if components == 1 else f"{count} {components}", precision)
    return (
        f'<Attribute Name={quoteattr(name)} AttributeType="{KINDS[components]}" '
        f'Center="Node">{item}</Attribute>'
    )


def grid(name: str, content: Iterable[str]) -> str:
    """A mesh with its fields."""
    lines = "\n".join(content)
    return f"<Grid Name={quoteattr(name)}>\n{lines}\n</Grid>"


def series(name: str, grids: Iterable[str]) -> str:
    """Grids over time."""
    lines = "\n".join(grids)
    return (
        f'<Grid Name={quoteattr(name)} GridType="Collection" '
        f'CollectionType="Temporal">\n{lines}\n</Grid>'
    )


def document(grids: Iterable[str]) -> str:
    """The text of a file."""
    lines = "\n".join(grids)
    return f'<?xml version="1.0"?>\n<Xdmf Version="3.0"><Domain>\n{lines}\n</Domain></Xdmf>\n'
