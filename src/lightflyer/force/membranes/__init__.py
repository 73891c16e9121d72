"""Force models of sandwiches of perforated membranes."""
