"""From one prediction to many: uncertainty."""
