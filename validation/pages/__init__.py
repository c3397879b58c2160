"""Pages and the schema that are written from what the package declares: `python -m validation.pages`."""
