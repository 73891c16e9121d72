"""What a layer can be made of: materials, mixtures, formulas of n and k."""
