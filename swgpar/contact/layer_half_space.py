"""Half space under loads that change along z, without the logarithm of the section.

At the distance s along the profile from a line load w(z),

    R(s; z, z') = 1 / r + 2 ln|s| delta(z - z'),    r² = s² + (z - z')².

R / (pi E') is the displacement without that of a load which is uniform along z.
"""

from __future__ import annotations

import numpy as np

SMALLEST = 1e-9
"""Distance (mm) along the profile that stands for none: R is continuous there."""


def among_lines(s: np.ndarray, z: np.ndarray, length: np.ndarray) -> np.ndarray:
    """R (n_line, n_line, ...) at distances s (...) mm: means over the shares of two lines, times
    the roots of their lengths.

    z, length : (n_line,) mm, of the lines and their shares of the face width
    """
    apart = np.maximum(np.abs(s), SMALLEST)
    low = z[0] - 0.5 * length[0] + np.append(0.0, np.cumsum(length)[:-1])
    high = low + length

    def between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Second integral of 1 / r over the distance of two ends."""
        t = (a[:, None] - b).reshape(len(a), len(b), *(1 for _ in apart.shape))
        return t * np.arcsinh(t / apart) - np.hypot(t, apart)

    means = between(high, low) - between(high, high) - between(low, low) + between(low, high)
    roots = np.sqrt(length[:, None] * length)
    own = np.eye(len(z))
    expand = (..., *(None for _ in apart.shape))
    return means / roots[expand] + 2.0 * np.log(apart) * own[expand]


def under_hats(s: np.ndarray, z: np.ndarray) -> np.ndarray:
    """R (..., n_z, n_z) at distances s (...) mm, at stations z (n_z,) mm under loads that are their
    hat functions."""
    apart = np.maximum(np.abs(s), SMALLEST)[..., None, None]
    low, high = z[:-1] - z[:, None], z[1:] - z[:, None]
    # integrals of 1 / r and t / r over a layer, t = z' - z
    even = np.arcsinh(high / apart) - np.arcsinh(low / apart)
    odd = np.hypot(high, apart) - np.hypot(low, apart)
    out = 2.0 * np.log(apart) * np.eye(len(z))
    out[..., :-1] += (high * even - odd) / np.diff(z)
    out[..., 1:] += (odd - low * even) / np.diff(z)
    return out
