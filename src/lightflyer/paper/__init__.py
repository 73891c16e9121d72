"""The published figures, tables and claims, each beside what this code gives."""
