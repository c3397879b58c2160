"""Close approaches of two ephemerides, and how likely the objects are to collide."""
