"""Files of spectra as instruments write them: one format a module."""
