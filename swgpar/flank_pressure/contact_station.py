"""Contact of two flanks at stations along the face width."""

from __future__ import annotations

from dataclasses import dataclass

from swgpar.contact.pressed_lines import PressedLine
from swgpar.flank_pressure.patch_contact import PatchContact

CELL_DIGITS = 6
"""Of the pressures of cells in contact_lines.csv."""


@dataclass(frozen=True)
class ContactStation:
    """Contact of two flanks at a station along the face width.

    z_mm : the station;  line_load_Nmm : N/mm
    s_mm : middle of the contact, arc length from the tip of the flexible spline's tooth;
    half_width_mm : of it;  of the one with the largest pressure, where flanks touch at two places
    pressure_MPa : largest pressure
    first_cell_mm : middle of the first cell across, arc length from the tip
    cell_width_mm, cell_length_mm : of every cell, across and along the face width
    cells_MPa : (n,) pressure of the cells across, constant on each
    """

    z_mm: float
    line_load_Nmm: float
    s_mm: float
    half_width_mm: float
    pressure_MPa: float
    first_cell_mm: float
    cell_width_mm: float
    cell_length_mm: float
    cells_MPa: tuple[float, ...]

    def row(self) -> dict[str, float]:
        """The columns of contact_lines.csv; those of the cells are p1_MPa and so on."""
        values = dict(vars(self))
        cells = values.pop("cells_MPa")
        digits = (float(f"{pressure:.{CELL_DIGITS}g}") for pressure in cells)
        return values | {f"p{k}_MPa": pressure for k, pressure in enumerate(digits, start=1)}


def line_station(line: PressedLine, strips: int) -> ContactStation:
    """The contact at a station, with its pressure on equal strips between the ends of the line.

    The largest pressure is that on strips of the contact which has it: those of the line are wide
    where it has two contacts far apart.
    """
    contact, width = line.contact, (line.high[-1] - line.low[0]) / strips
    low, high = contact.ends
    return ContactStation(
        z_mm=line.z,
        line_load_Nmm=line.line_load,
        s_mm=0.5 * (low + high),
        half_width_mm=0.5 * (high - low),
        pressure_MPa=contact.largest_mean(strips),
        first_cell_mm=float(line.low[0] + 0.5 * width),
        cell_width_mm=float(width),
        cell_length_mm=line.length,
        cells_MPa=tuple(line.strips(strips).tolist()),
    )


def patch_stations(patch: PatchContact) -> tuple[ContactStation, ...]:
    """The stations of a contact over a patch."""
    load, pressure = patch.line_load, patch.pressure
    return tuple(
        ContactStation(
            z_mm=float(patch.z[k]),
            line_load_Nmm=float(load[k]),
            s_mm=float(patch.middle[k]),
            half_width_mm=float(patch.half_width[k]),
            pressure_MPa=float(pressure[k]),
            first_cell_mm=float(patch.first[k]),
            cell_width_mm=patch.cell_width,
            cell_length_mm=patch.cell_length,
            cells_MPa=tuple(patch.cells[k].tolist()),
        )
        for k in range(len(patch.z))
    )
