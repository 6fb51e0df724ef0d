"""A mesh recipe of one's own: another recipe with twice as many elements along the root and through
the rim.

python mesh/refined_root.py --recipe plane_coarse --out results/refined_root.toml
mpirun -n 2 swgpar run drivers/plane_half_turn.toml --mesh results/refined_root.toml --out
results/refined_root
"""

from __future__ import annotations

import argparse
from pathlib import Path

import swgpar
from swgpar.input.toml_file import to_toml

DESIGN = Path(__file__).parents[1] / "drivers" / "plane_half_turn.toml"


def main() -> None:
    """Write the recipe and print the worst quality of its elements."""
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument(
        "--recipe", default="plane_coarse", help="name or path of the recipe to start from"
    )
    options.add_argument("--design", default=DESIGN, help="design file whose mesh is checked")
    options.add_argument(
        "--out", type=Path, default=Path("results/refined_root.toml"), help="the new recipe"
    )
    arguments = options.parse_args()

    counts = swgpar.load_mesh(arguments.recipe).model_dump(exclude_none=True)
    for name in ("root", "rim"):
        counts["flexible_spline"][name] *= 2
    recipe = swgpar.load_mesh(counts)

    mesh = swgpar.mesh(arguments.design, recipe)
    for body, values in mesh.quality.items():
        print(
            f"{body}: {values['elements']} elements, scaled Jacobian "
            f"{values['min_scaled_jacobian']:.3f} and more"
        )
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(to_toml(recipe.model_dump()), encoding="utf-8")


if __name__ == "__main__":
    main()
