"""Roughness of a surface in words."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts
from lightflyer.lab.estimate import Estimate, estimate_table
from lightflyer.lab.readers.height_map import NANOMETRE
from lightflyer.lab.surface.particles import count_objects

if TYPE_CHECKING:
    from lightflyer.lab.surface.reduction import Roughness

_PERCENT = 100.0
_MICROMETRE = 1e-6
_NAMES = {
    "rms_height": "rms height Sq",
    "mean_absolute_height": "mean absolute height Sa",
}


def finding_parts(parameters: Mapping[str, Estimate]) -> Parts:
    """The roughness in a sentence."""
    yield f"{_NAMES['rms_height']} {parameters['rms_height']}"


def roughness_parts(one: "Roughness") -> Parts:
    """Size of a map, what is masked, and its parameters."""
    rows, columns = one.height.shape
    source = one.source
    channel = f", {source.channel}" if source.channel else ""
    sides = " x ".join(f"{side / _MICROMETRE:.4g}" for side in (source.width, source.length))
    masked = ", ".join(
        f"{count_objects(mask)} {name} ({_PERCENT * mask.mean():.2f} %)"
        for name, mask in (("particles", one.particles), ("holes", one.holes))
    )
    yield (f"read {source.source}{channel}: {columns} x {rows} pixels, {sides} µm; {masked} masked")
    named = [(name, one.parameters[key]) for key, name in _NAMES.items()]
    yield estimate_table([*named, ("Sq without a mask", one.parameters_all["rms_height"])])
    skewness, kurtosis = (one.parameters[key].value for key in ("skewness", "kurtosis"))
    found = one.texture
    yield f"of this map: skewness Ssk {skewness:.3g}, kurtosis Sku {kurtosis:.3g}"
    yield (
        f"  correlation length (1/e) {found.correlation_length / _MICROMETRE:.3g} µm, "
        f"rms slope Sdq {found.rms_slope:.3g}\n"
        f"  developed area Sdr {_PERCENT * found.developed_area:.2g} %, "
        f"highest point Sp {found.highest / NANOMETRE:.3g} nm, "
        f"lowest Sv {found.deepest / NANOMETRE:.3g} nm"
    )


def means_parts(means: Mapping[str, Estimate], count: int) -> Parts:
    """Means of the parameters over several maps."""
    yield f"mean of {count} maps"
    yield estimate_table([(name, means[key]) for key, name in _NAMES.items()])
