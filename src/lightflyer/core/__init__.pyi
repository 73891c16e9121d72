from . import quantity as quantity
