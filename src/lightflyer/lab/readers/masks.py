"""Masks of height maps: pictures, as Gwyddion and paint programs have them, or matrices."""

import io
from pathlib import Path

import numpy as np
from PIL import Image

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab.readers.number_matrix import read_number_matrix


def read_mask(path: Path) -> np.ndarray:
    """Mask in a picture, where it is not black, or in a matrix of 0 and 1, (rows, columns)."""
    if path.suffix.lower() != ".png":
        values = read_number_matrix(path, "numbers of a mask").values
        if not np.isin(values, (0.0, 1.0)).all():
            raise ConfigurationError(f"{path}: a mask has 0 and 1, and nothing else")
        return values == 1.0
    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("L")) > 0
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror or error}") from None


def mask_as_png(mask: np.ndarray) -> bytes:
    """Picture of a mask, white where it masks."""
    content = io.BytesIO()
    Image.fromarray(np.where(mask, 255, 0).astype(np.uint8)).save(content, "PNG")
    return content.getvalue()
