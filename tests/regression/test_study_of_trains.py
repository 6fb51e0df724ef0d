"""A study of a gear train through the command: ranks, failures, restart, and the numbers of its
table."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import pytest
from mpi4py import MPI

from support.commands import execute, on_ranks, swgpar
from support.paths import DRIVERS
from swgpar import load_design
from swgpar.gear_trains.train import run_train
from swgpar.run_options import RunOptions

DESIGN = DRIVERS / "gear_pair.toml"
SMALL = ("monte_carlo.samples=500", "time.end=0.0005", "time.rows=10")
SHOWN = (
    "out_of_contact_2",
    "out_of_contact_3",
    "error_deviation_force_mesh_deflection_1",
    "error_mean_energy_gear_1_displacement_3",
)
CASES = [f"noise={noise}_half_backlash={half}" for noise in (50, 200) for half in (20, -1)]
KEPT, REFUSED = (
    [name for name in CASES if "=-1" not in name],
    [name for name in CASES if "=-1" in name],
)


def study_file(folder: Path, more: str = "") -> Path:
    """Four cases, of which two are refused."""
    path = folder / "study.toml"
    text = (
        f'[study]\ndesign = "{DESIGN}"\nset = {list(SMALL)}\nquantities = '
        f"{list(SHOWN)}\n{more}\n[study.vary]\n"
    )
    path.write_text(
        f"{text}load.noise = [50.0, 200.0]\nmesh.half_backlash = [20.0, -1.0]\n", encoding="utf-8"
    )
    return path


def study_command(path: Path, out: Path, *more: str, ranks: int = 1) -> list[str]:
    return on_ranks(ranks) + swgpar("study", path, "--out", out, *more)


def table(out: Path) -> list[dict[str, str]]:
    """Rows of study.csv without the seconds."""
    with open(out / "study.csv", newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if k != "wall_s"} for row in csv.DictReader(file)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    done = execute(study_command(study_file(folder), folder / "out"))
    assert (
        done.returncode == 5
        and "2 of 4 runs failed" in done.stderr
        and "Traceback" not in done.stderr
    )
    return folder / "out"


def test_the_table_has_what_a_run_gives(whole: Path, tmp_path: Path) -> None:
    rows = {row["case"]: row for row in table(whole)}
    assert list(rows) == CASES
    assert [name for name, row in rows.items() if row["status"] == "failed"] == REFUSED
    assert (
        "mesh.half_backlash = -1 is out of range: allowed 0 to 1000000 µm"
        in rows[REFUSED[0]]["reason"]
    )
    for name, noise in zip(KEPT, (50, 200), strict=True):
        design = load_design(DESIGN, [*SMALL, f"load.noise={noise}.0", "mesh.half_backlash=20.0"])
        run_train(design, RunOptions(tmp_path / name, comm=MPI.COMM_SELF))
        found = json.loads((tmp_path / name / "summary.json").read_text(encoding="utf-8"))[
            "quantities"
        ]
        # a run of a study names OpenBLAS' kernels before NumPy loads it, this process afterwards:
        # sums have another order
        assert {key: float(rows[name][key]) for key in SHOWN} == pytest.approx(
            {key: found[key] for key in SHOWN}, rel=1e-9
        )
        assert (float(rows[name]["load.noise"]), float(rows[name]["mesh.half_backlash"])) == (
            noise,
            20.0,
        )
    assert float(rows[KEPT[1]]["out_of_contact_3"]) > float(rows[KEPT[0]]["out_of_contact_3"]) > 0.0
    page = (whole / "study.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 1 and "Against load.noise" in page


def test_two_ranks_give_the_same(whole: Path, tmp_path: Path) -> None:
    done = execute(study_command(study_file(tmp_path), tmp_path / "out", ranks=2))
    assert done.returncode == 5
    assert table(tmp_path / "out") == table(whole)
    assert "1 rank\n" in (tmp_path / "out/cases" / KEPT[0] / "run.log").read_text(encoding="utf-8")


def test_all_ranks_on_one_case(whole: Path, tmp_path: Path) -> None:
    done = execute(
        study_command(study_file(tmp_path, "parallel = 'ranks'"), tmp_path / "out", ranks=2)
    )
    assert done.returncode == 5
    assert table(tmp_path / "out") == table(whole)
    assert "2 ranks" in (tmp_path / "out/cases" / KEPT[0] / "run.log").read_text(encoding="utf-8")


def test_restart(whole: Path, tmp_path: Path) -> None:
    """What is finished is kept; what was interrupted begins anew, whatever it has left; a changed
    design is refused."""
    path, out = study_file(tmp_path), tmp_path / "out"
    shutil.copytree(whole, out)
    refused = execute(study_command(path, out))
    assert refused.returncode == 4 and "--restart" in refused.stderr
    # as if the process had been killed between the history and the summary of a case
    folder, other = (out / "cases" / name for name in KEPT)
    status = json.loads((folder / "status.json").read_text(encoding="utf-8"))
    (folder / "status.json").write_text(
        json.dumps({**status, "status": "started"}), encoding="utf-8"
    )
    (folder / "summary.json").unlink()
    before = (other / "summary.json").read_bytes()
    done = execute(study_command(path, out, "--restart", ranks=2))
    assert done.returncode == 5 and done.stdout.count("finished before") == 1
    assert table(out) == table(whole) and (other / "summary.json").read_bytes() == before
    path.write_text(
        path.read_text(encoding="utf-8").replace("samples=500", "samples=600"), encoding="utf-8"
    )
    done = execute(study_command(path, out, "--restart"))
    assert done.returncode == 5 and all(row["status"] == "failed" for row in table(out))
    assert "holds results of another design" in table(out)[0]["reason"]


def test_meshes_are_refused_on_all_ranks(tmp_path: Path) -> None:
    path = study_file(tmp_path, "meshes = ['x.toml']")
    done = execute(study_command(path, tmp_path / "out", ranks=2), timeout=120.0)
    assert done.returncode == 2 and not (tmp_path / "out").exists()
    (sentence,) = done.stderr.splitlines()
    assert sentence.endswith(
        "study.meshes = ['x.toml'] has no meaning for a gear train: leave it out"
    )
