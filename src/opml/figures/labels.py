"""How an error component is written in a figure, and the unit it is drawn in."""


def axis(component: str) -> str:
    """The component's axis, `y` of `e_y`."""
    return component.removeprefix("e_")


def symbol(component: str) -> str:
    """The component as the paper writes it."""
    return rf"$e_{{{axis(component)}}}$"


def unit(component: str) -> tuple[str, float]:
    """The unit a component is drawn in, and how many of it one SI unit is: positions km, velocities m/s."""
    return ("m/s", 1.0) if axis(component).startswith("v") else ("km", 1e-3)
