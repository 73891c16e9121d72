"""Layers whose composition changes with depth."""

from numpy.typing import ArrayLike

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.compound import Compound, vector
from lightflyer.film.media.effective_media import Rule, Shape
from lightflyer.film.media.medium import Medium
from lightflyer.film.media.mixture import Mixture

SHEETS = 20  # Sheets of a graded layer, unless it says otherwise


class Graded(Compound):
    """A mixture whose fractions change linearly with depth, as sheets of one composition each.

    Attributes
    ----------
    parts : tuple of Medium
        See :class:`Mixture`.
    top, bottom : array, shape (parts - 1,)
        Volume fractions of the parts behind the first at the layer's upper and lower end [1].
    rule, shape, depolarisation, grain, measured_density
        See :class:`Mixture`.
    count : int
        Sheets; each has the composition of its middle.

    Notes
    -----
    The error of reflectance and transmittance falls with the square of the number of sheets.
    Results give it, from twice as many: see
    :func:`~lightflyer.film.optics.graded_sheets.sheet_error`.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> fading = Graded((material("Si"), material("SiO2")), 0.0, 1.0)
    >>> film = Film((Layer(fading, 200e-9),))
    >>> print(f"{film.optics(1e-6).reflectance[0]:.3f}")
    0.198
    """

    parts: tuple[Medium, ...]
    top: Numeric = field(converter=vector)
    bottom: Numeric = field(converter=vector)
    rule: Rule = field(static=True, default=Rule.BRUGGEMAN, converter=Rule.of)
    shape: Shape = field(static=True, default=Shape.SPHERES, converter=Shape.of)
    depolarisation: Numeric | None = None
    grain: float | None = field(static=True, default=None)
    measured_density: Numeric | None = None
    count: int = field(static=True, default=SHEETS)

    def __check_init__(self) -> None:
        if self.count < 1:
            raise ParameterError(f"count = {self.count} is no number of sheets")
        self._at(0.0), self._at(1.0)  # raise

    def _at(self, depth: float) -> Mixture:
        """The mixture at a depth, as a share of the thickness."""
        fractions = _between(self.top, self.bottom, depth)
        return Mixture(
            self.parts, fractions, self.rule, self.shape, self.depolarisation, self.grain,
            self.measured_density,
        )  # fmt: skip

    @property
    def name(self) -> str:
        """The parts' names."""
        return f"graded {self._at(0.5).name}"

    @property
    def density(self) -> Numeric | None:
        """Mean mass density [kg/m³]."""
        return self._at(0.5).density

    @property
    def density_source(self) -> str:
        """Where the density comes from, or which part has none."""
        return self._at(0.5).density_source

    @property
    def sheets(self) -> tuple[Medium, ...]:
        return tuple(self._at((number + 0.5) / self.count) for number in range(self.count))

    def flip(self) -> "Graded":
        return tree.replace_at(lambda one: (one.top, one.bottom), self, (self.bottom, self.top))

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        """Refractive index and extinction coefficient halfway down; see :meth:`Medium.index`."""
        return self._at(0.5).index(wavelength)

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warnings of the mixtures at both ends."""
        return tuple(dict.fromkeys((*self._at(0.0).diagnostics, *self._at(1.0).diagnostics)))


@entry_point
def _between(first: Numeric, last: Numeric, share: Numeric) -> Numeric:
    return first + share * (last - first)
