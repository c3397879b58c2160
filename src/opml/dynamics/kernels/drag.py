"""Acceleration by drag in an atmosphere that turns with the Earth."""

from opml.dynamics.kernels.lanes import compiled, sqrt


@compiled
def drag(x, y, z, vx, vy, vz, rotation, density, ballistic):
    """Return the acceleration [m/s2] of a sphere by drag, in the frame of the state (GCRF).

    x to vz: position [m] and velocity [m/s]
    rotation: the Earth's rotation vector [rad/s]
    density: [kg/m3]
    ballistic: Cd times area over mass [m2/kg] (Vallado 2013, sec. 8.6.2)
    """
    wx, wy, wz = rotation
    ux = vx - (wy * z - wz * y)
    uy = vy - (wz * x - wx * z)
    uz = vz - (wx * y - wy * x)
    speed = sqrt(ux * ux + uy * uy + uz * uz)
    factor = -0.5 * density * ballistic * speed
    return factor * ux, factor * uy, factor * uz
