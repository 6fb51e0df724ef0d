"""Kernels of OpenBLAS on processors that are newer than the library.

OpenBLAS chooses its kernels by the family and model of the processor, when it is loaded. An Intel
processor that it does not know gets those of 2004, without AVX (`Prescott`). With OpenBLAS 0.3.21
of Debian 12 on a Xeon of 2023 a product of matrices runs at 7 in place of 30 GFlop/s, and the cup
reference drive takes 70 in place of 56 s.
"""

from __future__ import annotations

from collections.abc import MutableMapping
from pathlib import Path

VARIABLE = "OPENBLAS_CORETYPE"
"""Environment variable by which OpenBLAS takes kernels by their name."""

KERNELS = (
    ("SkylakeX", frozenset({"avx512f", "avx512cd", "avx512bw", "avx512dq", "avx512vl"})),
    ("Haswell", frozenset({"avx2", "fma"})),
)
"""Names of kernels, and the instructions that each needs. Later kernels of OpenBLAS are the same in
double precision: with `Cooperlake` products have the seconds of `SkylakeX`."""


def choose_blas_kernels(
    environment: MutableMapping[str, str], processors: Path = Path("/proc/cpuinfo")
) -> None:
    """Name OpenBLAS' kernels by the instructions of the processor, unless the user named some.

    It counts for libraries that are loaded afterwards. Where `processors` (Linux) cannot be read,
    or the processor is another one, OpenBLAS chooses.
    """
    if VARIABLE in environment:
        return
    instructions = _instructions(processors)
    for name, needed in KERNELS:
        if needed <= instructions:
            environment[VARIABLE] = name
            return


def _instructions(processors: Path) -> frozenset[str]:
    """Of the first processor; of the others they are the same."""
    try:
        with processors.open(encoding="ascii", errors="replace") as lines:
            for line in lines:
                key, _, value = line.partition(":")
                if key.strip() == "flags":
                    return frozenset(value.split())
    except OSError:
        pass
    return frozenset()
