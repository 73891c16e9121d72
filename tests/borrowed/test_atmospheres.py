"""Public reports of atmospheres: tables and closed formulas of the standards.

Tests of other rooms have the cases of https://github.com/openrocket/openrocket/issues/2731,
https://github.com/AeroPython/PyFME/issues/110, https://github.com/sksat/trochia/pull/73 and
https://github.com/erf-model/ERF/issues/3593 (`validation/test_us1976_table.py`, and `gas` for
https://github.com/firemodels/fds/issues/13926), of
https://github.com/RocketPy-Team/RocketPy/pull/1056,
https://github.com/ssmichael1/satkit/pull/150 and
https://github.com/space-physics/msise00/issues/14 (`environment`).
"""

import numpy as np
import pytest

from lightflyer.environment.wind.heights import altitude_of


@pytest.mark.parametrize("latitude", [0.0, 45.0, 80.0, 90.0])
@pytest.mark.parametrize(("top", "error"), [(48e3, 3.0), (80e3, 20.0)])
def test_altitudes_of_a_geopotential(latitude, top, error):
    """https://github.com/ESCOMP/CAM/issues/987 and https://github.com/stcorp/harp/issues/21

    Gravity weakens with height and grows towards the poles: by Somigliana's formula, and the
    radius of the ellipsoid with its centrifugal part, integrated by small steps.
    """
    sine = np.sin(np.radians(latitude)) ** 2
    ground = 9.7803253359 * (1.0 + 0.00193185265241 * sine) / np.sqrt(1.0 - 0.00669437999013 * sine)
    flattening, centrifugal = 1.0 / 298.257223563, 0.00344978650684
    heights = np.linspace(0.0, top, 8001)
    free = (
        1.0
        - 2.0 / 6378137.0 * (1.0 + flattening + centrifugal - 2.0 * flattening * sine) * heights
        + 3.0 / 6378137.0**2 * heights**2
    )
    geopotential = np.trapezoid(ground * free, heights)
    assert altitude_of(geopotential, np.radians(latitude)) == pytest.approx(top, abs=error)
    # in geopotential metres 80 km are 1 km lower
    assert geopotential / 9.80665 < top - 9e-8 * top**2
