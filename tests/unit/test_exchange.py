"""Files of other programs, opened by others: OpenCASCADE for STEP, ezdxf for DXF, VTK, Arrow."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pandas
import pytest
import pyvista

import swgpar
from support import drive_groups
from support.cup_shapes import SHAPES, shaped
from support.cup_shapes import wall_volume as revolved_wall
from support.paths import DESIGN, RECIPE
from support.small_drive import PLANE, SHORT
from swgpar.design.drive_design import DriveDesign
from swgpar.design.sections import Housing
from swgpar.errors import InputError, SwgparError
from swgpar.exchange.outlines import (
    FLANK_POINTS,
    TOLERANCE,
    flank_edges,
    gear_outline,
)
from swgpar.exchange.step import closed_curve
from swgpar.exchange.tables import write_look_up
from swgpar.exchange.vtkhdf import step_times
from swgpar.geometry.cams import cam_outlines
from swgpar.meshing.gmsh_session import gmsh_model
from swgpar.results.fields import TIME_STEP, times
from swgpar.results.table import read_columns


def small(**request: object) -> DriveDesign:
    return swgpar.new(ratio=20.0, diameter=42.0, torque=5.0, **request)


def drive_with(profile: str, cam: str, model: str) -> DriveDesign:
    """A drive with any profile and cam: `swgpar.new` has neither conjugate teeth nor asymmetric
    cams."""
    if profile == "conjugate":
        return swgpar.load_design(
            drive_groups.PLANE, {"ring_gear.profile": {"type": "conjugate", "r_root": 0.2}}
        )
    if cam != "asymmetric_parabolic":
        return small(profile=profile, cam=cam, model=model)
    design = small(profile=profile, cam="parabolic", model=model)
    section = design.wave_generator
    side = {"a_p": section.a_p, "C_p": section.C_p, "r_c": section.r_c}
    values = {
        "type": cam,
        "face_width": section.face_width,
        "C": section.C,
        "rotational_angle": 2.0,
    }
    sides = {"right": side, "left": {**side, "C_p": 0.9 * section.C_p}}
    return design.with_values({"wave_generator": {**values, **sides}})


def section_area(design: DriveDesign, gear: str) -> float:
    """Area within the toothed outline, by Green's theorem on a fine polygon of the exact flank and
    exact arcs."""
    profile = design.profile(gear)
    x, y = profile.point(np.linspace(0.0, profile.length, 20001)).T
    flank = -0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
    land = profile.polar_angle(0.0)[0]
    root = np.pi / profile.n_teeth - profile.polar_angle(profile.length)[0]
    half = flank + 0.5 * profile.r_tip_circle**2 * land + 0.5 * profile.r_root_circle**2 * root
    return float(2.0 * profile.n_teeth * half)


def wall_volume(design: DriveDesign) -> float:
    """Volume of the cup's wall, by Pappus's theorem."""
    cup, t, r = design.cup, design.cup_sizes.thickness, design.inner_radius
    cylinder = np.pi * ((r + t) ** 2 - r**2) * (cup.length - cup.fillet_radius)
    middle = r + t - cup.fillet_radius
    end = np.pi * (middle**2 - cup.inner_radius**2) * t
    outer, inner = cup.fillet_radius, cup.fillet_radius - t
    a = cup.back_fillet  # the corner less a quarter of a disc: area and radius of its centroid
    corner = (
        (1.0 - 0.25 * np.pi)
        * a**2
        * 2.0
        * np.pi
        * (r + t + a * (1.0 - (1.0 / 6.0) / (1.0 - 0.25 * np.pi)))
    )
    quarter = [
        0.25 * np.pi * x**2 * 2.0 * np.pi * (middle + 4.0 * x / (3.0 * np.pi))
        for x in (outer, inner)
    ]
    return float(cylinder + end + corner + quarter[0] - quarter[1])


@pytest.mark.parametrize(
    "profile, cam, model, fillet",
    [
        ("quadruple_arc", "elliptical", "cup", 0.08),
        ("involute", "parabolic", "cup", 0.0),
        ("double_arc", "simplified", "plane", 0.0),
        ("involute", "four_roller", "plane", 0.0),
        ("conjugate", "elliptical", "plane", 0.0),
        ("quadruple_arc", "asymmetric_parabolic", "plane", 0.0),
    ],
)
def test_volumes_of_step_files(
    tmp_path: Path,
    profile: str,
    cam: str,
    model: str,
    fillet: float,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Of all profiles and cams: OpenCASCADE's volumes of the bodies it reads, against integrals of
    the exact curves."""
    design = drive_with(profile, cam, model).with_values({"ring_gear.housing.thickness": 5.0})
    if model == "cup":
        same = design.cup_sizes.thickness  # of the closed end, which `wall_volume` takes
        keys = {"cup.back_fillet": fillet, "cup.end_thickness": same}
        design = design.with_values(keys)
    paths = swgpar.export(design, tmp_path, ["step"])
    assert capfd.readouterr().out == ""
    width = design.drive.face_width
    outer = design.profile("ring_gear").r_root_circle + design.ring_gear.rim
    bore = np.pi * design.inner_radius**2
    x, y = design.cam().outline(20_000).T
    volumes = {
        "flexible_spline": (section_area(design, "flexible_spline") - bore) * width,
        "ring_gear": (np.pi * outer**2 - section_area(design, "ring_gear")) * width,
        "wave_generator": 0.5 * abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) * width,
        "housing": np.pi * ((outer + 5.0) ** 2 - outer**2) * width,
    }
    if model == "cup":
        volumes["flexible_spline"] += wall_volume(design)
    if cam == "four_roller":
        volumes["wave_generator"] = 4.0 * np.pi * design.wave_generator.r_4**2 * width
    assert [path.stem for path in paths] == list(volumes)
    for path in paths:
        with gmsh_model("read") as gmsh:
            solids = [entity for entity in gmsh.model.occ.importShapes(str(path)) if entity[0] == 3]
            assert len(solids) == (
                4 if path.stem == "wave_generator" and cam == "four_roller" else 1
            )
            volume = sum(gmsh.model.occ.getMass(*solid) for solid in solids)
            assert volume == pytest.approx(volumes[path.stem], rel=1e-4), path.stem


@pytest.mark.parametrize("shape", list(SHAPES))
def test_volumes_of_step_files_of_other_cups(tmp_path: Path, shape: str) -> None:
    design = shaped(SHAPES[shape])
    path = swgpar.export(design, tmp_path, ["step"])[0]
    bore = np.pi * design.inner_radius**2
    toothed = (section_area(design, "flexible_spline") - bore) * design.drive.face_width
    with gmsh_model("read") as gmsh:
        solids = [entity for entity in gmsh.model.occ.importShapes(str(path)) if entity[0] == 3]
        assert len(solids) == 1
        volume = gmsh.model.occ.getMass(*solids[0]) - toothed
    assert volume == pytest.approx(revolved_wall(design), rel=1e-4)  # asked: 1e-3


@pytest.mark.parametrize("profile", ["quadruple_arc", "double_arc", "involute"])
def test_outlines_close_and_follow_the_exact_flank(profile: str) -> None:
    design = small(profile=profile, model="plane")
    for gear in ("flexible_spline", "ring_gear"):
        edges = gear_outline(design, gear)
        for edge, following in zip(edges, [*edges[1:], edges[0]], strict=True):
            assert edge.points[-1] == pytest.approx(following.points[0], abs=1e-9)
        exact = design.profile(gear)
        for edge in flank_edges(exact):
            if edge.center is not None:
                radius = np.hypot(*(edge.points - edge.center).T)
                assert radius[0] == pytest.approx(radius[1], abs=1e-9)
            assert np.abs(exact.distance(edge.points)[0]).max() < 1e-9


@pytest.mark.parametrize("cam", ["elliptical", "parabolic", "simplified"])
def test_curves_of_the_kernel_stay_within_their_tolerance(cam: str) -> None:
    """The B-spline that OpenCASCADE lays through the points, against the exact cam and an exact
    involute."""
    design = small(profile="involute", cam=cam, model="plane")
    (points,) = cam_outlines(design.cam())
    flank = max(
        flank_edges(design.profile("flexible_spline")), key=lambda edge: len(edge.points)
    ).points
    assert len(flank) == FLANK_POINTS
    with gmsh_model("curves") as gmsh:
        occ = gmsh.model.occ
        closed = closed_curve(gmsh, points, design.cam().evaluate(points)[1], 0.0)
        side = occ.addSpline([occ.addPoint(*p, 0.0) for p in flank])
        occ.synchronize()
        found = []
        for curve in (*closed, side):
            (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
            between = np.linspace(low, high, 2011)
            found.append(gmsh.model.getValue(1, curve, between).reshape(-1, 3)[:, :2])
    assert np.abs(design.cam().evaluate(np.concatenate(found[:-1]))[0]).max() < TOLERANCE
    assert np.abs(design.profile("flexible_spline").distance(found[-1])[0]).max() < TOLERANCE


@pytest.mark.parametrize(
    "profile, cam",
    [("quadruple_arc", "elliptical"), ("involute", "four_roller"), ("double_arc", "simplified")],
)
def test_dxf_passes_the_audit(tmp_path: Path, profile: str, cam: str) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    design = small(profile=profile, cam=cam, model="plane")
    housing = {"housing": Housing(thickness=5.0)} if cam == "elliptical" else {}
    design = design.model_copy(update={"ring_gear": design.ring_gear.model_copy(update=housing)})
    (path,) = swgpar.export(design, tmp_path, ["dxf"])
    document = ezdxf.readfile(path)
    assert not document.audit().has_errors and document.units == 4
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert layers == {"flexible_spline", "ring_gear", "wave_generator", *housing}
    if profile == "quadruple_arc":  # the arcs as DXF has them: their ends are on the exact flank
        exact = design.profile("flexible_spline")
        arcs = [e for e in document.modelspace().query("ARC") if e.dxf.layer == "flexible_spline"]
        ends = np.array([[*e.start_point][:2] for e in arcs] + [[*e.end_point][:2] for e in arcs])
        near = ends[(np.abs(np.arctan2(*ends.T)) < np.pi / exact.n_teeth) & (ends[:, 0] > 1e-6)]
        assert len(near) > 4 and np.abs(exact.distance(near)[0]).max() < TOLERANCE


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("exchange") / "run"
    swgpar.run(
        swgpar.load_design(DESIGN, [*PLANE, *SHORT, "output.figures=false", "output.fields=true"]),
        RECIPE,
        out,
    )
    return out


def test_vtk_reads_the_fields(folder: Path, tmp_path: Path) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    result = swgpar.open_result(folder)
    (path,) = swgpar.export(result, tmp_path, ["vtkhdf"])
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == result.increments
    for step in (0, result.increments - 1):
        reader.SetStep(step)
        reader.Update()
        grid, expected = reader.GetOutputDataObject(0), result.grid(step, whole=True)
        assert grid.GetNumberOfCells() == expected.n_cells
        assert vtk_to_numpy(grid.GetPoints().GetData()) == pytest.approx(
            np.asarray(expected.points)
        )
        for name in ("displacement", "vm", "s1"):
            values = vtk_to_numpy(grid.GetPointData().GetArray(name))
            assert values == pytest.approx(
                np.asarray(expected.point_data[name]), rel=1e-6, abs=1e-9
            ), name


def test_meshio_and_vtk_read_the_whole_drive_as_xdmf(folder: Path, tmp_path: Path) -> None:
    result = swgpar.open_result(folder)
    (path, data) = swgpar.export(result, tmp_path, ["xdmf"])
    assert path.name == "drive.xdmf" and data.exists()
    vtk_reader, last = pyvista.XdmfReader(str(path)), result.increments - 1
    expected = result.grid(last, whole=True)
    when = step_times(result)
    assert vtk_reader.time_values == pytest.approx(when)
    with meshio.xdmf.TimeSeriesReader(path) as reader:
        points, (cells,) = reader.read_points_cells()
        time, fields, body = reader.read_data(last)
    assert time == when[-1] == pytest.approx(result.history["wg_angle_deg"][-1])
    assert np.array_equal(points, expected.points) and np.array_equal(
        cells.data, expected.cells.reshape(-1, 9)[:, 1:]
    )
    assert np.array_equal(body["body"][0], expected.cell_data["body"])
    vtk_reader.set_active_time_value(when[-1])
    series = vtk_reader.read()[0]
    for name in ("displacement", "vm", "s1"):
        assert np.array_equal(fields[name], expected.point_data[name])
        assert np.array_equal(series.point_data[name], expected.point_data[name])
    assert np.array_equal(fields["stress"], expected.point_data["stress"])


def test_vtk_finds_the_bodies_by_their_names_at_every_time(folder: Path) -> None:
    """Names that return get brackets from VTK's reader."""
    reader = pyvista.XdmfReader(str(folder / "fields.xdmf"))
    assert reader.time_values == pytest.approx(step_times(swgpar.open_result(folder)))
    for time in reader.time_values:
        reader.set_active_time_value(time)
        assert reader.read().keys() == ["flexible_spline", "ring_gear"]


def test_other_programs_read_the_tables(folder: Path) -> None:
    result = swgpar.open_result(folder)
    for name in ("history", "pairs"):
        table = pandas.read_csv(folder / f"{name}.csv", float_precision="round_trip")
        assert list(table) == list(getattr(result, name))
        numbers = table.select_dtypes("number")
        assert len(numbers.columns) > 10
        # an empty column of texts is one of numbers to pandas
        columns = getattr(result, name)
        for column in [one for one in numbers if columns[one].dtype.kind != "U"]:
            assert np.array_equal(table[column], columns[column], equal_nan=True), column


@pytest.mark.parametrize("model", [(), PLANE], ids=["solid", "plane"])
def test_other_programs_read_the_meshes(model: tuple[str, ...], tmp_path: Path) -> None:
    """VTK for VTU, gmsh for MSH, meshio for INP; CalculiX computes with INP in test_inp.py."""
    mesh = swgpar.mesh(swgpar.load_design(DESIGN, [*model]), RECIPE)
    vtu, msh, inp = mesh.write(tmp_path)
    bodies = mesh.bodies
    points = np.concatenate([body.points for body in bodies.values()])
    grid, deck = pyvista.read(vtu), meshio.read(inp)
    assert np.array_equal(grid.points, points)
    assert deck.points == pytest.approx(points, abs=1e-11)
    first = 0
    for number, (body, cells, block) in enumerate(
        zip(bodies.values(), split_cells(grid), deck.cells, strict=True)
    ):
        expected = body.cells + first
        assert np.array_equal(cells, expected) and np.array_equal(block.data, expected), number
        first += len(body.points)
    with gmsh_model("read") as gmsh:
        gmsh.merge(str(msh))
        dimension = 2 if model else 3
        for tag, (name, body) in enumerate(bodies.items(), 1):
            assert gmsh.model.getPhysicalName(dimension, tag) == name
            (entity,) = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
            _, elements, _ = gmsh.model.mesh.getElements(dimension, entity)
            assert len(elements[0]) == len(body.cells)
            quality = gmsh.model.mesh.getElementQualities(elements[0], "minDetJac")
            assert quality.min() > 0.0


def split_cells(grid: pyvista.UnstructuredGrid) -> list[np.ndarray]:
    """Cells of both bodies of a grid."""
    (cells,), body = grid.cells_dict.values(), grid.cell_data["body"]
    return [cells[body == number] for number in (0, 1)]


def test_times_are_angles_that_increase() -> None:
    found = times(np.array([0.0, 0.0, 0.0, 2.0, 4.0]))
    assert found.tolist() == [0.0, TIME_STEP, 2.0 * TIME_STEP, 2.0, 4.0]


def test_tables_as_parquet(folder: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    result = swgpar.open_result(folder)
    paths = swgpar.export(result, tmp_path, ["parquet"])
    files = {path.stem for path in folder.glob("*.csv")}
    assert {"history", "pairs"} <= files == {path.stem for path in paths}
    table = parquet.read_table(tmp_path / "history.parquet")
    assert table.column("fs_s1").to_numpy() == pytest.approx(
        result.history["fs_s1"], rel=0.0, abs=0.0
    )


def test_loads_of_bolts_as_parquet(folder: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    result = swgpar.open_result(folder)
    result.bolts = {"shear_N": np.array([1.0, 2.5])}
    swgpar.export(result, tmp_path, ["parquet"])
    assert parquet.read_table(tmp_path / "bolts.parquet")["shear_N"].to_pylist() == [1.0, 2.5]


def test_the_ripple_of_a_result(tmp_path: Path) -> None:
    class Sampled:
        program: dict[str, np.ndarray] = {}
        summary = SimpleNamespace(stiffness=None, losses=None)
        transmission_error = {
            "wg_angle_deg": np.array([0.0, 90.0, 180.0, 270.0]),
            "transmission_error_arcsec": np.array([1.0, 3.0, 1.0, -1.0]),
        }

    (path,) = write_look_up(Sampled(), tmp_path)
    table = read_columns(path)
    assert table["wave_generator_angle_rad"][1] == pytest.approx(0.5 * np.pi)
    assert table["kinematic_error_rad"] * 648000.0 / np.pi == pytest.approx(
        [0.0, 2.0, 0.0, -2.0], abs=1e-12
    )


def test_formats_that_a_source_does_not_have(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match='format = "step" is not available for a result: allowed vtkhdf'
    ):
        swgpar.export(folder, tmp_path, ["step"])
    with pytest.raises(
        InputError, match='format = "vtkhdf" is not available for a design: allowed step, dxf, csv'
    ):
        swgpar.export(DESIGN, tmp_path, ["vtkhdf"])
    with pytest.raises(InputError, match="lookup needs a run with"):
        swgpar.export(folder, tmp_path, ["lookup"])


def test_errors_of_gmsh_have_a_sentence() -> None:
    with pytest.raises(SwgparError, match="^Gmsh cannot make part: "), gmsh_model("part") as gmsh:
        gmsh.model.occ.addCircle(0.0, 0.0, 0.0, -1.0)
