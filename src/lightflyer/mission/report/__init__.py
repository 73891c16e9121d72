"""A mission as a dataset, figures, tables and words."""
