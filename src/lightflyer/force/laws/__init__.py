"""Laws of thin gas, as plain functions of plain numbers."""
