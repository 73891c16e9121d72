from .convex import Outline as Outline
from .convex import convex_drag as convex_drag
from .convex import sphere_outline as sphere_outline
from .disk import disk_drag as disk_drag
from .disk import edgewise_disk_drag as edgewise_disk_drag
