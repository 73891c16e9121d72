"""Files in and out: TOML, sections, tables, display units, figures, pages."""
