import pytest

import lightflyer as lf

FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}


@pytest.fixture(scope="session")
def film_section():
    """The section [film] of :func:`flyer`."""
    return FILM


@pytest.fixture(scope="session")
def flyer():
    """The paper's disk as a flyer file."""
    return lf.FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, environment={"atmosphere": "lu2023"})


@pytest.fixture(scope="session")
def design(flyer):
    return flyer.design()
