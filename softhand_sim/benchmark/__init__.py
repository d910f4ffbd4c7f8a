"""Many trials side by side, their statistics, table and pictures."""
