"""Acceleration by the Sun, the Moon and the planets, relative to the Earth's centre."""

from opml.dynamics.kernels.lanes import compiled, splat, sqrt


@compiled
def third_bodies(x, y, z, bodies, gms, count):
    """Return the acceleration [m/s2] by `count` point masses, in the frame of the positions (GCRF).

    bodies: geocentric positions [m], three numbers a body
    gms: gravitational parameters [m3/s2]

    Battin's f(q) combines the direct and the indirect term without cancellation for far bodies (Battin,
    Mathematics and Methods of Astrodynamics, 1999, sec. 8.4).
    """
    ax, ay, az = splat(0.0), splat(0.0), splat(0.0)
    for k in range(count):
        sx, sy, sz = bodies[3 * k], bodies[3 * k + 1], bodies[3 * k + 2]
        s2 = sx * sx + sy * sy + sz * sz
        q = (x * (x - 2.0 * sx) + y * (y - 2.0 * sy) + z * (z - 2.0 * sz)) * (1.0 / s2)
        ratio = 1.0 + q
        cube = ratio * sqrt(ratio)
        beyond = 1.0 + cube
        # One division makes two quotients, as a division costs as much as thirty multiplications.
        inverse = 1.0 / (cube * beyond)
        f = q * (3.0 + q * (3.0 + q)) * (cube * inverse)
        pull = (gms[k] / (s2 * s2**0.5)) * (beyond * inverse)
        ax = ax - pull * (x + f * sx)
        ay = ay - pull * (y + f * sy)
        az = az - pull * (z + f * sz)
    return ax, ay, az
