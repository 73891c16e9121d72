"""Files as instruments write them."""
