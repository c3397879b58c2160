"""How files of each kind of measurement are checked, and what fits of their tables are made to."""
