"""Pages of catalogues: scores of what was learned, and a day of many objects."""
