"""How files of each kind of measurement are checked."""
