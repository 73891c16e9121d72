"""What light and heat radiation do in a stack of layers."""
