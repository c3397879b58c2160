"""Requests to a run: settings and studies, the experiments that answer them, and their files' names."""
