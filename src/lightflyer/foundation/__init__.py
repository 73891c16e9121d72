"""What every room stands on: precision, root-finding, units, ranges, files, figures, errors."""
