"""Files of spectra as instruments write them: one format a module; :mod:`lightflyer.lab.readers.spectrum_data` reads all."""
