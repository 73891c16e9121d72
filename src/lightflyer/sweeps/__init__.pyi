from .run import open_sweep as open_sweep
from .run import sweep as sweep
