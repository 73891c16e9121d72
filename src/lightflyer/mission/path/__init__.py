"""The way of a flyer: position, forces, integration over time."""
