"""The settings as typed models: the one place where a key, its meaning, unit, limits and default stand."""
