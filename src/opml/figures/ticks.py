"""Ticks of axes: lengths in metres or kilometres."""

MINUS = "\N{MINUS SIGN}"  # as axes write it


def metres(size: float, _: int = 0) -> str:
    """Return a size [m] as an axis writes it: `100 m`, `10 km`."""
    text = f"{size / 1e3:g} km" if abs(size) >= 1e3 else f"{size:g} m"
    return text.replace("-", MINUS)


def rounded(size: float) -> float:
    """Return a size with two significant digits."""
    return float(f"{size:.2g}")
