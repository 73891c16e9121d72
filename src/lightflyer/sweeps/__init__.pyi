from .figures import plot_sweep as plot_sweep
from .run import open_sweep as open_sweep
from .run import sweep as sweep
