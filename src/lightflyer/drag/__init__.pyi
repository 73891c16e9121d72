from .convex import Outline as Outline
from .disk import disk_drag as disk_drag
