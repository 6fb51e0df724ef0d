"""Slow cycles of what moves in a revolution."""

from __future__ import annotations

import numpy as np

SLOWEST_WAVE = 18
"""Largest number of cycles in a revolution that counts as slow: tooth meshes come faster."""


def dominant_cycles(values: np.ndarray, revolutions: float = 1.0) -> float:
    """Slow cycles in a revolution with the largest amplitude. values : (n,), equally spaced"""
    amplitude = np.abs(np.fft.rfft(values))[: int(SLOWEST_WAVE * revolutions) + 1]
    return float((1 + np.argmax(amplitude[1:])) / revolutions)
