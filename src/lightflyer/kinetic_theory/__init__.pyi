from .chamber.enclosure import Chamber as Chamber
from .chamber.enclosure import Surface as Surface
from .chamber.solution import ChamberSolution as ChamberSolution
from .chamber.solution import solve_in_chamber as solve_in_chamber
from .moving import MovingSolution as MovingSolution
from .moving import solve_moving as solve_moving
from .solver import Solution as Solution
from .solver import solve as solve
