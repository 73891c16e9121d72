from .explore import best_designs as best_designs
from .explore import pareto_front as pareto_front
from .explore import quantiles as quantiles
from .figures import plot_sweep as plot_sweep
from .run import open_sweep as open_sweep
from .run import sweep as sweep
