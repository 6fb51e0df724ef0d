"""Whole runs of gear trains through the command: result files, any number of ranks, refusals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from support.commands import execute, on_ranks, succeed, swgpar
from support.paths import DRIVERS
from support.small_trains import SMALL
from swgpar import open_result
from swgpar.errors import OutputError
from swgpar.results.table import read_columns

FILES = {
    "cascade": ("population", "static", "stack_up", "gaps", "sorting", "spectrum"),
    "gear_pair": ("density_1", "density_2", "density_3"),
    "planetary": ("rims", "mesh_forces", "modes"),
    "ring_moving_load": ("modes", "mode_shapes", "critical_speeds", "monte_carlo"),
}


def run(name: str, out: Path, *, ranks: int = 1, figures: bool = False) -> list[str]:
    keys = [*SMALL[name], f"output.figures={str(figures).lower()}"]
    design = DRIVERS / f"{name}.toml"
    return on_ranks(ranks) + swgpar("run", design, "--out", out, "--set", *keys)


@pytest.mark.parametrize("name", FILES)
def test_results_are_the_same_on_any_number_of_ranks(name: str, tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    done = succeed(run(name, one, figures=True))
    succeed(run(name, two, ranks=2))
    assert "measured against computed" in done.stdout and "Warning" not in done.stderr + done.stdout
    for file in ("history.csv", "published.csv", *(f"tables/{table}.csv" for table in FILES[name])):
        assert (one / file).read_bytes() == (two / file).read_bytes(), file
    summary = json.loads((two / "summary.json").read_text(encoding="utf-8"))
    assert summary["ranks"] == 2 and summary["design"]["gear_train"]["model"] == name.removesuffix(
        "_moving_load"
    )
    rows = read_columns(one / "published.csv")
    assert len(rows["quantity"]) >= 2
    figures = list((one / "figures").glob("*.png"))
    assert len(figures) > 3 and min(figure.stat().st_size for figure in figures) > 5000


def test_figures_are_drawn_again_and_results_kept(tmp_path: Path) -> None:
    out = tmp_path / "run"
    succeed(run("ring_moving_load", out, figures=True))
    (figure, *_) = (out / "figures").glob("*.png")
    figure.unlink()
    succeed(swgpar("report", out))
    assert figure.exists()
    again = execute(run("ring_moving_load", out))
    assert again.returncode == 4 and "already holds results" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--restart",), "restart has no meaning for a gear train"),
        (("--mesh", "x.toml"), "mesh has no meaning for a gear train"),
        (("--set", "gear_train.model=belt"), 'gear_train.model = "belt" is not available'),
    ],
)
def test_refused_on_all_ranks(arguments: tuple[str, ...], reason: str, tmp_path: Path) -> None:
    out = tmp_path / "run"
    done = execute(
        on_ranks(2) + swgpar("run", DRIVERS / "cascade.toml", "--out", out, *arguments),
        timeout=120.0,
    )
    assert done.returncode == 2 and reason in done.stderr and len(done.stderr.splitlines()) == 1
    assert not out.exists()


def test_folders_of_earlier_versions_open(tmp_path: Path) -> None:
    """Their summary has no answers, and some quantities beside the others."""
    out = tmp_path / "run"
    succeed(run("planetary", out))
    now = open_result(out).summary
    content = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert {row["name"] for row in content.pop("answers")} == set(now)
    aside = ("sampling_error_percent", "least_eigenvalue_over_largest", "asymmetry_of_correlations")
    content |= {name: content["quantities"].pop(name) for name in aside}
    content["task_s"] = {"linearised": [1.0, 2.0], "monte_carlo": 3.0}
    (out / "summary.json").write_text(json.dumps(content), encoding="utf-8")
    earlier = open_result(out).summary
    assert dict(earlier) == dict(now) and now["out_of_contact"].value is not None
    del content["ranks"]
    (out / "summary.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(OutputError, match="is not the summary of a gear train"):
        open_result(out)
