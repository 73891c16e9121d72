r"""Light and heat radiation between two parallel sheets with holes, as functions of plain numbers.

Radiation between the sheets goes to and fro. What is absorbed in the end follows from two balances,
of the radiosity upward and downward:

.. math::
    U = \tau_b E_\mathrm{below} + M_b + \rho_b D, \qquad
    D = \tau_t E_\mathrm{above} + M_t + \rho_t U

with the effective properties of sheets with holes and the exitances :math:`M` of the two inner
faces. All functions take arrays that broadcast, and are differentiable.
"""

from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.film.properties import FilmProperties


class Sheet(NamedTuple):
    """Effective properties of a sheet with its holes, over its whole area."""

    # Absorbed share of the radiation on each face [1]. For heat radiation these are the emittances
    # too
    absorptance_top: Numeric
    absorptance_bottom: Numeric
    # Share of the radiation on each face that passes, through holes and film [1]
    transmittance_top: Numeric
    transmittance_bottom: Numeric

    @property
    def reflectance_top(self) -> Numeric:
        """Reflected share of the radiation on the top face [1]."""
        return 1.0 - self.absorptance_top - self.transmittance_top

    @property
    def reflectance_bottom(self) -> Numeric:
        """Reflected share of the radiation on the bottom face [1]."""
        return 1.0 - self.absorptance_bottom - self.transmittance_bottom


class Exitance(NamedTuple):
    """What a sheet emits, over its whole area."""

    top: Numeric  # Power per area of each face [W/m²]
    bottom: Numeric  # Power per area of each face [W/m²]


DARK = Exitance(0.0, 0.0)  # No emission, as of light


def perforate(
    absorptance_top: Numeric,
    absorptance_bottom: Numeric,
    transmittance: Numeric,
    open_fraction: Numeric,
    transmittance_bottom: Numeric | None = None,
) -> Sheet:
    r"""Effective properties of a film with holes."""
    # .. math:: a' = (1-\beta)\,a, \qquad \tau' = \beta + (1-\beta)\,\tau
    solid = 1.0 - open_fraction
    below = transmittance if transmittance_bottom is None else transmittance_bottom
    return Sheet(
        solid * absorptance_top,
        solid * absorptance_bottom,
        open_fraction + solid * transmittance,
        open_fraction + solid * below,
    )


def sheet_in_light(film: FilmProperties, open_fraction: Numeric) -> Sheet:
    """Effective properties of a film with holes in light."""
    return perforate(
        film.absorptance,
        film.absorptance_below,
        film.transmittance,
        open_fraction,
        film.transmittance_below,
    )


def sheet_in_infrared(film: FilmProperties, open_fraction: Numeric, temperature: Numeric) -> Sheet:
    """Effective properties of a film with holes for heat radiation."""
    top, bottom = film.emittances_at(temperature)
    return perforate(top, bottom, film.infrared_transmittance_at(temperature), open_fraction)


def net_gains(
    top: Sheet,
    bottom: Sheet,
    above: Numeric,
    below: Numeric,
    emitted_top: Exitance = DARK,
    emitted_bottom: Exitance = DARK,
) -> tuple[Array, Array]:
    """Net power that each of two parallel sheets gains by radiation, per area [W/m²]."""
    # The sheets are wide and near, so that nothing leaves between them sideways. Radiation meets
    # the holes of one sheet wherever it passed those of the other: holes that lie above each other
    # let more of a vertical beam through.
    up, down = _between(top, bottom, above, below, emitted_top, emitted_bottom)
    gain_top = top.absorptance_top * above + top.absorptance_bottom * up
    gain_bottom = bottom.absorptance_bottom * below + bottom.absorptance_top * down
    return (
        gain_top - emitted_top.top - emitted_top.bottom,
        gain_bottom - emitted_bottom.top - emitted_bottom.bottom,
    )


def leaving_downward(
    top: Sheet,
    bottom: Sheet,
    above: Numeric,
    below: Numeric,
    emitted_top: Exitance = DARK,
    emitted_bottom: Exitance = DARK,
) -> Array:
    """Radiation that leaves two parallel sheets downward, per area [W/m²]."""
    _, down = _between(top, bottom, above, below, emitted_top, emitted_bottom)
    return (
        bottom.transmittance_top * down + emitted_bottom.bottom + bottom.reflectance_bottom * below
    )


def _between(
    top: Sheet,
    bottom: Sheet,
    above: Numeric,
    below: Numeric,
    emitted_top: Exitance,
    emitted_bottom: Exitance,
) -> tuple[Array, Array]:
    """Radiosities upward and downward between two sheets [W/m²]."""
    upward = bottom.transmittance_bottom * below + emitted_bottom.top
    downward = top.transmittance_top * above + emitted_top.bottom
    trapped = top.reflectance_bottom * bottom.reflectance_top
    # between perfect mirrors no radiation enters and none is emitted
    escape = xp.where(trapped == 1.0, 1.0, 1.0 - trapped)
    up = (upward + bottom.reflectance_top * downward) / escape
    down = (downward + top.reflectance_bottom * upward) / escape
    return up, down
