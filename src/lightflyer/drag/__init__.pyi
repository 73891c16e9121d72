from .disk import disk_drag as disk_drag
from .disk import edgewise_disk_drag as edgewise_disk_drag
from .inertia import disk_inertia as disk_inertia
from .inertia import sphere_inertia as sphere_inertia
