"""Public data fetched into one folder: space weather, Earth orientation, element sets and their history."""
