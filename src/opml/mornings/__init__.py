"""Every morning of an object: what is new is fitted, predicted and judged; an ephemeris leaves."""
