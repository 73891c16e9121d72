from .air import AIR as AIR
from .air import GASES as GASES
from .air import LU2023_AIR as LU2023_AIR
from .air import Air as Air
from .air import Lu2023Air as Lu2023Air
from .base import AbstractGas as AbstractGas
from .base import knudsen_number as knudsen_number
from .base import mean_free_path as mean_free_path
