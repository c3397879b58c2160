"""Forecasts of the space weather from what is known on a day; each method is a module."""
