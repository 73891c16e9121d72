"""What everybody stands on: errors, types, constants, quantities with units, checks, progress."""
