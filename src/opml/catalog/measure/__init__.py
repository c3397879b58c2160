"""Checks of files, by kind of measurement."""
