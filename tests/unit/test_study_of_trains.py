"""Studies of gear trains: expansion without meshes, quantities of each train, refusals, tables and
figures."""

from __future__ import annotations

import csv
import io
import pickle
from collections.abc import Callable
from pathlib import Path

import pytest

from support.paths import DRIVERS, ROOT
from support.small_trains import result_with
from support.study_files import assert_refused, jobs_of
from swgpar.results.table import format_csv
from swgpar.studies.case import Outcome
from swgpar.studies.cases import labels
from swgpar.studies.figures import over_angle, over_key
from swgpar.studies.report import make_report
from swgpar.studies.spec import load_study
from swgpar.studies.table import compare_cases, published_rows, study_rows

Write = Callable[..., Path]


@pytest.fixture
def study_file(tmp_path: Path) -> Write:
    """Function that writes a study of a gear train: further lines of [study], then the rest of the
    file."""

    def write(design: str, rest: str = "", *, more: str = "") -> Path:
        path = tmp_path / "study.toml"
        text = f'[study]\ndesign = "{DRIVERS / design}.toml"\n{more}\n{rest}'
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_cases_have_no_meshes(study_file: Write) -> None:
    vary = "[study.vary]\ng1_g1.gap_B = [0.2, 0.4]\nload.peak = [150.0]\n"
    jobs = jobs_of(study_file("cascade", vary, more="set = ['load.forces=[100.0]']"))
    assert [job.title for job in jobs] == ["gap_B=0.2_peak=150", "gap_B=0.4_peak=150"]
    assert [job.case.design.g1_g1.gap_B for job in jobs] == [0.2, 0.4]
    assert jobs[0].folder(Path("out")) == Path("out/cases/gap_B=0.2_peak=150")
    assert (jobs[0].mesh, jobs[0].recipe, jobs[0].finer, jobs[0].increments) == (None, None, 0, 1)
    # the file's own published values have no place in designs that may not compute them
    assert not jobs[0].case.design.published and not jobs[0].case.design.output.figures


@pytest.mark.parametrize(
    ("design", "name", "unit"),
    [
        ("cascade", "first_crossing_static", "kN"),
        ("cascade", "static_B_120[8]", ""),
        ("gear_pair", "error_deviation_force_mesh_deflection_1", "%"),
        ("planetary", "deviation_ring_contact_radial", "m"),
        ("ring_moving_load", "critical_speeds[5]", "rad/s"),
        ("ring_modes", "frequencies[1]", "Hz"),
        ("ring_supported", "dimensionless_frequencies[1]", ""),
    ],
)
def test_quantities_are_those_of_the_train(
    study_file: Write, design: str, name: str, unit: str
) -> None:
    (job,) = jobs_of(study_file(design))
    # rank 0 reads the study, and sends the jobs to the others
    assert pickle.loads(pickle.dumps(job)).case.design == job.case.design
    main = [title for title, quantity in job.case.known.items() if not quantity.detail]
    assert job.case.name == design and list(job.case.shown) == main
    assert job.case.known[name].unit == unit
    assert "(" not in job.case.known[name].meaning.replace("2 pi sqrt(density A R⁴ / (E I))", "")


def test_a_list_stands_for_its_numbers(study_file: Write) -> None:
    entry = (
        "[[study.case]]\nname = 'a'\npublished = { static_equal_B_120 = [0.13, 0.12], "
        "overloaded_static = 0 }\n"
    )
    entry += "tolerance = { static_equal_B_120 = 5.0 }\n"
    more = "quantities = ['static_equal_B_120', 'first_crossing_static']"
    (job,) = jobs_of(study_file("cascade", entry, more=more))
    assert job.case.shown == (
        "static_equal_B_120[1]",
        "static_equal_B_120[2]",
        "first_crossing_static",
    )
    found = {
        "static_equal_B_120[1]": 0.1339,
        "static_equal_B_120[2]": 0.1154,
        "overloaded_static": 0.0,
    }
    results = [(job, Outcome("finished", values=found, wall_s=1.0))]
    first, second, count = published_rows(compare_cases(results))
    assert list(first) == [
        "case",
        "quantity",
        "unit",
        "published",
        "computed",
        "difference_percent",
        "tolerance_percent",
        "verdict",
    ]
    assert (first["difference_percent"], first["verdict"]) == (pytest.approx(3.0), "inside")
    assert (second["tolerance_percent"], count["tolerance_percent"]) == (5.0, None)
    assert (count["computed"], count["difference_percent"]) == (0.0, None)


def test_quantities_may_be_those_of_some_cases(study_file: Write) -> None:
    """The names of quantities follow from the design: a case without one leaves its cell empty."""
    vary = "[study.vary]\nload.forces = [[100.0], [120.0, 200.0]]\n"
    jobs = jobs_of(
        study_file(
            "cascade", vary, more="quantities = ['dynamic_mean_B_200', 'dynamic_mean_B_100']"
        )
    )
    assert [job.case.name for job in jobs] == ["forces=100", "forces=120,200"]
    assert jobs[0].case.shown == ("dynamic_mean_B_100[1]", "dynamic_mean_B_100[2]")
    rows = study_rows(
        [(job, Outcome("finished", values=dict.fromkeys(job.case.shown, 0.5))) for job in jobs]
    )
    assert [row["dynamic_mean_B_200[2]"] for row in rows] == [None, 0.5]
    assert [row["dynamic_mean_B_100[2]"] for row in rows] == [0.5, None]
    text = format_csv(rows).decode()
    assert [row["load.forces"] for row in csv.DictReader(io.StringIO(text))] == [
        "[100.0]",
        "[120.0, 200.0]",
    ]
    assert "mesh" not in rows[0] and "elements" not in rows[0] and "newton_mean" not in rows[0]


@pytest.mark.parametrize(
    ("rest", "more", "words"),
    [
        (
            "",
            "meshes = ['a.toml']",
            "study.meshes = ['a.toml'] has no meaning for a gear train: leave it out",
        ),
        (
            "",
            "compared = 'a.toml'",
            'study.compared = "a.toml" has no meaning for a gear train: leave it out',
        ),
        (
            "[[study.case]]\nname = 'a'\nmeshes = ['a.toml']\n",
            "",
            "study.case \"a\": meshes = ['a.toml'] has no meaning for a gear train: leave it out",
        ),
        (
            "",
            "set = ['gear_train.model=belt']",
            'every case is refused: gear_train.model = "belt" is not available',
        ),
        (
            "[study.vary]\ng1.teeth = [3]\n",
            "",
            "every case is refused: g1.teeth = 3 is out of range: allowed 6 to 1000",
        ),
        (
            "",
            "quantities = ['overloaded_statik']",
            "study.quantities = overloaded_statik is not a quantity of a run",
        ),
        ("", "quantities = ['x']", "allowed spearman_rack_pinion, largest_error_rack_pinion"),
        (
            "[[study.case]]\nname = 'a'\npublished.first_crosing_static = 150.0\n",
            "",
            "published.first_crosing_static is not a quantity of a run: did you mean "
            "first_crossing_static?",
        ),
        (
            "[[study.case]]\nname = 'a'\npublished.braked_B = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n",
            "",
            "published.braked_B[9] is",
        ),
        ("[[study.case]]\nname = 'a'\npublished.braked_B = 1.0\n", "", "did you mean braked_B["),
        (
            "[[study.case]]\nname = 'a'\npublished.braked_B = ['x']\n",
            "",
            "is not a table of numbers",
        ),
    ],
)
def test_a_wrong_study_file_is_refused_in_one_sentence(
    study_file: Write, rest: str, more: str, words: str
) -> None:
    assert_refused(study_file("cascade", rest, more=more), words)


def test_a_refused_train_is_a_case(study_file: Write) -> None:
    jobs = jobs_of(study_file("cascade", "[study.vary]\nload.peak = [200.0, 247.0]\n"))
    assert (
        jobs[0].case.refusal
        == "load.forces = 207 is out of range: allowed above 0 to 200 kN (load.peak)"
    )
    assert jobs[1].case.design is not None


def test_figures_and_report(study_file: Write, tmp_path: Path) -> None:
    """In step, the other varied keys make no lines of their own; numbers in lists of one count as
    numbers."""
    vary = "[study.vary]\nload.input = [[1e4], [2e4], [4e4]]\nload.output = [[2e4], [4e4], [8e4]]\n"
    path = study_file("gear_pair", vary, more="mode = 'sweep'")
    jobs = jobs_of(path)
    assert [job.case.name for job in jobs] == [
        f"input={k}_output={2 * k}" for k in (10000, 20000, 40000)
    ]
    results = [
        (j, Outcome("finished", values=dict.fromkeys(j.case.known, float(k))))
        for k, j in enumerate(jobs)
    ]
    assert len(list(over_angle(results))) == 0
    assert (
        len(list(over_key(results, "load.input", in_step=True))) == 2
    )  # 18 quantities, 12 in a figure
    assert len(list(over_key(results, "load.input", in_step=False))) == 0
    page = make_report(load_study(path), results, compare_cases(results), tmp_path).decode()
    assert page.count("data:image/png;base64,") == 4 and "Against load.output" in page
    assert (
        "error of the force-based standard deviation of the mesh deflection y1 - y2 + z against "
        "Monte Carlo, case 1"
        '</td><td class="text">%' in page
    )


def test_lists_of_numbers_have_short_names() -> None:
    assert labels([[1.5, 2], [3.0], "x", True]) == ["1.5,2", "3", "x", "true"]


def test_what_a_train_does_not_have_is_left_out(study_file: Write) -> None:
    """Peaks of the ring that are not there are NaN in its summary: no values."""
    (job,) = jobs_of(study_file("ring_moving_load"))
    quantities = {"critical_speeds": [30.0, float("nan")], "dominant_cycles_moving_point": 6.0}
    found = job.case.system.measure(result_with(quantities, {}))
    assert (
        found.values == {"critical_speeds[1]": 30.0, "dominant_cycles_moving_point": 6.0}
        and found.wall_s == 2.0
    )


def test_the_example_of_the_documentation(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "howto" / "studies.md").read_text(encoding="utf-8")
    example = text.partition("## Gear trains")[2].partition("```toml\n")[2].partition("```")[0]
    path = tmp_path / "study.toml"
    path.write_text(example.replace("../", f"{DRIVERS}/"), encoding="utf-8")
    jobs = jobs_of(path)
    assert [job.case.name for job in jobs] == [
        f"{n}_gap_B={g}" for n in ("stiff", "source") for g in (0.3, 0.4, 0.482)
    ]
    assert all(job.case.design is not None and len(job.case.shown) == 3 for job in jobs)
