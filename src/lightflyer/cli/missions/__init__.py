"""Commands that fly missions."""
