from .figures import plot_sweep as plot_sweep
from .reduced import open_reduced as open_reduced
from .reduced import sweep_reduced as sweep_reduced
from .run import open_sweep as open_sweep
from .run import sweep as sweep
