"""``[film]`` of a sample: layers as in a flyer file, which may lie on a substrate."""

from typing import ClassVar

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Length, OpenFraction, Thickness
from lightflyer.film.layer_section import LayerSection
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.film.media.medium import Extrapolation, Medium
from lightflyer.film.optics.stack import Film


class SubstrateSection(LayerSection):
    """``substrate``: what the layers lie on, endless or so thick that light does not interfere."""

    thickness: Thickness | None = None
    coherent: bool = False


class SampleSection(LayeredFilmSection):
    """``[film]`` for ``lightflyer film``: of a flyer, or of a sample on a substrate."""

    of_other_files: ClassVar[bool] = True

    substrate: SubstrateSection | None = None
    ambient: SubstrateSection | None = None
    open_fraction: OpenFraction | None = None
    hole_diameter: Length | None = None

    @pydantic.model_validator(mode="after")
    def _possible(self) -> "SampleSection":
        if self.ambient is not None and self.ambient.thickness is not None:
            raise ConfigurationError("ambient has no thickness: light comes from within it")
        if self.hole_diameter is not None and self.open_fraction is None:
            raise ConfigurationError("hole_diameter needs open_fraction, the holes' share of area")
        for name in ("substrate", "ambient"):
            if self.open_fraction is not None and getattr(self, name) is not None:
                raise ConfigurationError(f"open_fraction: a film with holes has no {name}")
        return self

    @property
    def written_layers(self) -> tuple[LayerSection, ...]:
        """The layers as the file gives them, with a substrate that has a thickness."""
        if self.substrate is None or self.substrate.thickness is None:
            return self.layers
        return (*self.layers, self.substrate)

    def film(self) -> Film:
        """The layers with their materials, between what is above and below."""
        endless = self.substrate is not None and self.substrate.thickness is None
        bottom = self.substrate.roughness if endless and self.substrate else self.roughness_bottom
        return Film(
            tuple(layer.build(self.extrapolation) for layer in self.written_layers),
            above=self._medium(self.ambient),
            below=self._medium(self.substrate) if endless else None,
            roughness_below=None if bottom is None else bottom.value,
            open_fraction=None if self.open_fraction is None else self.open_fraction.value,
            hole_diameter=None if self.hole_diameter is None else self.hole_diameter.value,
        )

    def _medium(self, section: SubstrateSection | None) -> Medium | None:
        if section is None:
            return None
        return section.medium(Extrapolation(section.extrapolation or self.extrapolation))
