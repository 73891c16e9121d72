"""Force models of bodies that gas flows through: plates with channels, hollow bodies."""
