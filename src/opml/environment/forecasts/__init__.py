"""The forecast of the space weather from the weather known on a day, and the futures about it."""
