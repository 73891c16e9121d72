"""Tables of raw measurements, read by the package's one reader."""

from lightflyer.foundation.layout import Column
from lightflyer.foundation.table import Rejected, Table, read_table

__all__ = ["Column", "Rejected", "Table", "read_table"]
