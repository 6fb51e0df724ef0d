"""Exact cam curves of wave generators. A new cam is a new file here and an entry in `make_cam`."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from swgpar.cams.elliptical import EllipticalCam


class Cam(Protocol):
    def evaluate(self, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Signed distance (n,), outward unit normal (n, 2) and k (n,), Hessian = k t t^T, at points (n, 2)."""


def make_cam(design) -> Cam:
    """Cam curve of a design, major axis along +y."""
    return EllipticalCam(design.a, design.b)


__all__ = ["Cam", "EllipticalCam", "make_cam"]
