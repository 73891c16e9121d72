"""Tilt, bow and scan lines of a height map: their removal, and the roughness it takes along."""

from typing import Literal

import numpy as np
from scipy import fft, ndimage

Flatten = Literal["none", "rows"]  # What is done to the rows of a map before it is levelled


def level(height: np.ndarray, mask: np.ndarray | None = None, order: int = 2) -> np.ndarray:
    """Subtract the polynomial that fits a map best [m], shape (rows, columns)."""
    # Legendre polynomials are nearly orthogonal on the pixels: well-conditioned normal equations
    rows, columns = (np.linspace(-1.0, 1.0, count) for count in height.shape)
    along = [np.polynomial.Legendre.basis(degree) for degree in range(order + 1)]
    first, second = np.array([(i, j) for i in range(order + 1) for j in range(order + 1 - i)]).T
    ys = np.stack([one(rows) for one in along])
    xs = np.stack([one(columns) for one in along])
    kept = np.ones(height.shape) if mask is None else (~mask).astype(float)
    # separate products over rows and columns avoid a matrix with a row for every pixel
    products = np.einsum("ar,br,rc,dc,ec->abde", ys, ys, kept, xs, xs, optimize=True)
    normal = products[first[:, None], first, second[:, None], second]
    residual = height - height[kept > 0.0].mean()
    for _ in range(2):  # the second pass removes rounding errors of the first
        moments = ys @ (residual * kept) @ xs.T
        coefficients = np.zeros_like(moments)
        coefficients[first, second] = np.linalg.solve(normal, moments[first, second])
        residual = residual - ys.T @ coefficients @ xs
    return residual


def fill_missing(height: np.ndarray) -> np.ndarray:
    """Heights with each missing one replaced by the nearest that is there [m]."""
    missing = np.isnan(height)
    if not missing.any():
        return height
    nearest: np.ndarray = np.asarray(
        ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
    )
    return np.asarray(height[nearest[0], nearest[1]])


def flatten_rows(height: np.ndarray, order: int = 0) -> np.ndarray:
    """Shift each row so that the median of its differences from the row before is zero [m]."""
    # A particle changes the median of the differences little, unlike the mean of a row. The tilt is
    # the median of the slopes between pixels half a row apart. Steps and drift between scan lines
    # vanish, and with them the part of the roughness that varies between rows only.
    steps = np.diff(height, axis=0)
    columns = height.shape[1]
    place = np.arange(columns) - 0.5 * (columns - 1)
    correction = np.zeros_like(steps)
    if order:
        half = columns // 2
        slopes = np.median(steps[:, half:] - steps[:, :-half], axis=1) / half
        correction = slopes[:, None] * place
    correction = correction + np.median(steps - correction, axis=1, keepdims=True)
    flat = height.copy()
    flat[1:] -= np.cumsum(correction, axis=0)
    return flat


def kept_power(
    shape: tuple[int, int], modes: int, order: int, rows: int | None = None
) -> np.ndarray:
    """Share of the power of each cosine mode of a surface that levelling keeps."""
    along = [_mode_shares(count, modes, max(order, rows or 0)) for count in shape]
    lost = sum(
        np.outer(along[0][i], along[1][j]) for i in range(order + 1) for j in range(order + 1 - i)
    )
    if rows is not None:
        lost = np.maximum(lost, along[1][: rows + 1].sum(axis=0)[None, :])
    return np.clip(1.0 - lost, 0.0, 1.0)


def _mode_shares(count: int, modes: int, order: int) -> np.ndarray:
    """Squared cosine coefficients of orthonormal polynomials; shape (order + 1, modes)."""
    place = np.linspace(-1.0, 1.0, count)
    polynomials = np.linalg.qr(np.polynomial.legendre.legvander(place, order))[0]
    return fft.dct(polynomials, axis=0, norm="ortho")[:modes].T ** 2
