"""Shared tools: precision, root-finding, units, ranges, files, figures, errors."""
