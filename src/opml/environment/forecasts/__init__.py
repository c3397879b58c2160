"""Methods that forecast the space weather from the weather known on a day, one module each."""
