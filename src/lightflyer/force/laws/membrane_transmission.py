r"""Molecules that meet two perforated membranes: what passes, and what leaves at which temperature.

Outside, the membranes are one thin disk. Its upper and its lower plane send back or let through
what arrives, and emit what the membranes warmed:

.. math:: m_p = \sum_i E_{pi}\,\theta_i, \qquad p, i \in \{t, b\}

:math:`E` is the share of the molecules leaving a plane that last met a membrane and took its
temperature. By reciprocity it is as well the share of those arriving at a plane that leave their
energy on a membrane. Two limits are known:

- *aligned*: the holes lie above each other and the gap is narrow. A molecule passes both membranes
  or none, and meets outer faces only.
- *wide*: the gap is much wider than the holes, and molecules in it forget where they came from. Of
  those arriving, :math:`\beta/(2-\beta)` pass, most of them after meeting an inner face.
"""

from typing import Literal, NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.force.laws.gap import accommodation_between

Transmission = Literal["aligned", "wide"]
"""How the holes and the gap of a sandwich let molecules pass."""


class MembraneTransmission(NamedTuple):
    r"""Shares of free molecules that meet two membranes."""

    open_fraction: Numeric  # Share of the arriving molecules that leaves on the other side [1]
    # Share of the molecules leaving the upper plane that the top membrane warmed, :math:`E_{tt}`,
    # and likewise below, :math:`E_{bb}` [1]
    top: Numeric
    bottom: Numeric
    # Share of those leaving the upper plane that the bottom membrane warmed, :math:`E_{tb}`, and of
    # those leaving the lower plane that the top membrane warmed, :math:`E_{bt}` [1]
    top_by_bottom: Numeric
    bottom_by_top: Numeric
    # Share of the area where film faces film across the gap, as molecules see it [1]
    facing: Numeric
    facing_tac: Numeric  # Accommodation coefficient that the facing films have together [1]
    meeting: Numeric  # Share of the arriving molecules that meets a membrane at all [1]

    @property
    def even(self) -> Numeric:
        r"""Emission of a plane by the mean excess, on average of both planes [1]."""
        return 0.5 * (self.top + self.bottom + self.top_by_bottom + self.bottom_by_top)

    @property
    def odd(self) -> Numeric:
        r"""Half the difference of the planes' emissions by half that of the excesses [1]."""
        return 0.5 * (self.top + self.bottom - self.top_by_bottom - self.bottom_by_top)

    @property
    def unlike(self) -> Numeric:
        r"""Half the difference of the planes' emissions, bottom minus top, by the mean excess."""
        return 0.5 * (self.bottom + self.bottom_by_top - self.top - self.top_by_bottom)

    @property
    def tac(self) -> Numeric:
        """TAC of a disk with aligned holes of :attr:`open_fraction` that stands for this [1]."""
        return self.even / self.meeting

    @property
    def thin_share(self) -> Numeric:
        r"""Accommodated share of that disk, :math:`s\bar\alpha` [1]."""
        return (1.0 - self.open_fraction) * self.tac

    def emission(self, excess_top: Numeric, excess_bottom: Numeric) -> tuple[Numeric, Numeric]:
        """Emissions of the upper and lower plane [1]."""
        return (
            self.top * excess_top + self.top_by_bottom * excess_bottom,
            self.bottom * excess_bottom + self.bottom_by_top * excess_top,
        )

    def recoil(self, excess_top: Numeric, excess_bottom: Numeric) -> tuple[Array, Array]:
        r"""Recoil of the molecules that leave the planes, over half the gas pressure [1]."""
        # Free molecules push with the difference of :math:`\sum_i E_{pi}(\sqrt{1+\theta_i}-1)`
        # below and above.
        root_top, root_bottom = xp.sqrt(1.0 + excess_top), xp.sqrt(1.0 + excess_bottom)
        # differences of roots, written without cancellation
        apart = (excess_bottom - excess_top) / (root_bottom + root_top)
        both = excess_bottom / (root_bottom + 1.0) + excess_top / (root_top + 1.0)
        return self.odd * apart, self.unlike * both

    def heat(
        self, excess: tuple[Numeric, Numeric], even_return: Numeric, odd_return: Numeric
    ) -> tuple[Array, Array]:
        r"""Heat that the gas outside takes from the membranes [1]."""
        # The gas brings back :math:`e_p`: shares of what leaves the planes on average, and of half
        # the difference.
        #
        # .. math:: Q_i = \sum_p E_{pi}\,(\theta_i - e_p)
        top, bottom = excess
        above, below = self.emission(top, bottom)
        mean, half = 0.5 * (above + below), 0.5 * (below - above)
        # planes that absorb differently return less of the one in proportion to the other
        unlike = self.unlike
        even = even_return * (mean - unlike * odd_return * half)
        odd = odd_return * (half - unlike * even_return * mean)
        above, below = even - odd, even + odd
        return (
            self.top * (top - above) + self.bottom_by_top * (top - below),
            self.bottom * (bottom - below) + self.top_by_bottom * (bottom - above),
        )


def passage(
    transmission: Transmission,
    open_fraction: Numeric,
    outer: tuple[Numeric, Numeric],
    inner: tuple[Numeric, Numeric],
) -> MembraneTransmission:
    r"""Passage through two membranes; ``open_fraction``: of each membrane, :math:`\beta`."""
    # For a wide gap, with :math:`e = s\alpha` and :math:`r = s(1-\alpha)` of the inner faces, the
    # fluxes down and up in the gap are
    #
    # .. math::
    #     D = e_t\theta_t + r_t U + \beta\,m_\mathrm{above}, \qquad
    #     U = e_b\theta_b + r_b D + \beta\,m_\mathrm{below}
    #
    # For complete accommodation, what drives the force on free molecules is then
    # :math:`s^2(\theta_b-\theta_t)`, and not :math:`s`: molecules that leave through a hole come
    # from the other membrane as well.
    solid = 1.0 - open_fraction
    own = solid * outer[0], solid * outer[1]
    if transmission == "aligned":
        facing_tac = accommodation_between(*inner)
        return MembraneTransmission(open_fraction, *own, 0.0, 0.0, solid, facing_tac, solid)
    emitted = solid * inner[0], solid * inner[1]
    reflected = solid - emitted[0], solid - emitted[1]
    again = 1.0 / (1.0 - reflected[0] * reflected[1])
    through = open_fraction * again
    return MembraneTransmission(
        open_fraction / (2.0 - open_fraction),
        own[0] + through * reflected[1] * emitted[0],
        own[1] + through * reflected[0] * emitted[1],
        through * emitted[1],
        through * emitted[0],
        solid**2,
        inner[0] * inner[1] * again,
        1.0 - open_fraction**2,
    )
