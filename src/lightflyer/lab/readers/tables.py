"""Tables of raw measurements, read by the package's one reader."""

from lightflyer.files.table import Rejected, Table, read_table
from lightflyer.files.table_layout import Column

__all__ = ["Column", "Rejected", "Table", "read_table"]
