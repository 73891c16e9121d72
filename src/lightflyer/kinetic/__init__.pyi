from .figures import draw_flow as draw_flow
from .figures import flow_figure as flow_figure
from .moving import MovingSolution as MovingSolution
from .moving import solve_moving as solve_moving
from .solver import Solution as Solution
from .solver import solve as solve
