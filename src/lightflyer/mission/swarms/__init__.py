"""Many flyers: spread by the wind, or tethered to one payload."""
