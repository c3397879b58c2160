"""What an evaluation of the forces costs, kernel by kernel, beside what its arithmetic must cost.

The arithmetic is counted from the formulas: multiplications and additions, and the vector instructions that
do them where a product and a sum make one. Each kernel is timed alone, its data in the nearest cache, in a
loop in which every pass takes up the result of the one before.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks import case, measure
from opml.base.constants import DAY
from opml.dynamics.kernels import dop853, dtm2000, surroundings
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS, acceleration
from opml.dynamics.kernels.drag import drag
from opml.dynamics.kernels.geodetic import geodetic
from opml.dynamics.kernels.gravity import gravity
from opml.dynamics.kernels.lanes import WIDTH, entry, load, rows, splat, sqrt, store
from opml.dynamics.kernels.radiation_pressure import illumination, radiation_pressure
from opml.dynamics.kernels.shadow_edges import RATES
from opml.dynamics.kernels.surroundings import BODIES, SPIN, SUN_ITRF, ForceModel, look_up
from opml.dynamics.kernels.third_body import third_bodies

REGISTER = 8
"""Doubles in one AVX-512 register."""

EVALUATIONS = 12
"""Of the forces in a step: eleven stages, as the first is the step before's last, and the end."""

_REPEATS = 40


@dataclass(frozen=True)
class Work:
    """Arithmetic of one evaluation for one arc.

    operations: multiplications and additions; instructions: with a product and its sum as one; divisions and
    roots, which a processor does in a unit of its own, one after the other.
    """

    operations: int
    instructions: int
    divisions: int = 0
    roots: int = 0


@dataclass(frozen=True)
class Machine:
    """Time [ns] of one instruction on one register, where nothing waits."""

    fused: float
    division: float
    root: float

    @property
    def peak(self) -> float:
        """Multiplications and additions a nanosecond, with a product and a sum in each instruction."""
        return 2.0 * REGISTER / self.fused

    def least(self, work: Work) -> float:
        """Return the time [ns] of the arithmetic for one arc, with the two units one after the other."""
        fused = work.instructions * self.fused
        return (fused + work.divisions * self.division + work.roots * self.root) / REGISTER


def gravity_work(model: ForceModel) -> Work:
    """Return the work: six fused sums and four operations a harmonic; six sums and a turn an order."""
    terms, orders = len(model.weights), model.columns
    return Work(operations=16 * terms + 18 * orders + 6, instructions=9 * terms + 10 * orders + 6)


def third_body_work(model: ForceModel) -> Work:
    """Return the work of one body after the other."""
    count = len(model.gms)
    return Work(operations=33 * count, instructions=24 * count, divisions=count, roots=count)


def density_work() -> Work:
    """Return the work: eight sums, the harmonics they are over, six exponentials and a logarithm."""
    sums = 8 * dtm2000.FACTORS
    return Work(operations=2 * sums + 27 + 108 + 341, instructions=sums + 18 + 90 + 266, divisions=5)


def stage_work() -> Work:
    """Return the part of a step's sums that falls on one evaluation, error estimate included."""
    products = 6 * (np.count_nonzero(dop853.INNER) + np.count_nonzero(dop853.OUTER) + EVALUATIONS)
    estimate = 6 * (np.count_nonzero(dop853.ERROR_3) + np.count_nonzero(dop853.ERROR_5)) + 60
    count = round((products + estimate) / EVALUATIONS)
    return Work(operations=2 * count, instructions=count)


GEODETIC = Work(operations=35, instructions=29, divisions=3, roots=4)
DRAG = Work(operations=23, instructions=18, roots=1)
PRESSURE = Work(operations=26, instructions=32, divisions=1, roots=1)
REST = Work(operations=61, instructions=42, divisions=1, roots=1)
"""Rotations to the Earth and back, the central term, the distance, the local time, the sum of the forces."""


def machine() -> Machine:
    """Measure the processor's throughput by independent chains of one instruction."""
    data, count = rows(2), 20_000
    data[0] = 1.5
    times = [
        measure.best(lambda chain=chain: chain(count, data), repeats=_REPEATS)
        for chain in (_fused, _divisions, _roots)
    ]
    registers = count * 8 * (WIDTH // REGISTER)
    return Machine(*(1e9 * seconds / registers for seconds in times))


@entry
def _fused(count, data):
    a = load(data, 0)
    s, t, u, v = splat(0.1), splat(0.2), splat(0.3), splat(0.4)
    w, x, y, z = splat(0.5), splat(0.6), splat(0.7), splat(0.8)
    for _ in range(count):
        s, t, u, v = s * a + a, t * a + a, u * a + a, v * a + a
        w, x, y, z = w * a + a, x * a + a, y * a + a, z * a + a
    store(data, 1, s + t + u + v + w + x + y + z)


@entry
def _divisions(count, data):
    a = load(data, 0)
    s, t, u, v = splat(1.1), splat(1.2), splat(1.3), splat(1.4)
    w, x, y, z = splat(1.5), splat(1.6), splat(1.7), splat(1.8)
    for _ in range(count):
        s, t, u, v = a / s, a / t, a / u, a / v
        w, x, y, z = a / w, a / x, a / y, a / z
    store(data, 1, s + t + u + v + w + x + y + z)


@entry
def _roots(count, data):
    s, t, u, v = splat(1.1), splat(1.2), splat(1.3), splat(1.4)
    w, x, y, z = splat(1.5), splat(1.6), splat(1.7), splat(1.8)
    for _ in range(count):
        s, t, u, v = sqrt(s), sqrt(t), sqrt(u), sqrt(v)
        w, x, y, z = sqrt(w), sqrt(x), sqrt(y), sqrt(z)
    store(data, 1, s + t + u + v + w + x + y + z)


@entry
def _gravity(count, state, model):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    for _ in range(count):
        r2 = x * x + y * y + z * z
        ax, ay, az = gravity(
            x, y, z, 1.0 / sqrt(r2), model.weights, model.columns, model.degree, model.gm, model.radius
        )
        x, y, z = x + 1e-9 * ax, y + 1e-9 * ay, z + 1e-9 * az
    store(state, 8, x + y + z)


@entry
def _third_bodies(count, state, model, values):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    for _ in range(count):
        ax, ay, az = third_bodies(x, y, z, values[BODIES:], model.gms, model.gms.shape[0])
        x, y, z = x + ax, y + ay, z + az
    store(state, 8, x + y + z)


@entry
def _geodetic(count, state):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    for _ in range(count):
        altitude, sin_lat, cos_lat, sin_lon, cos_lon = geodetic(x, y, z, 1.0 / sqrt(x * x + y * y + z * z))
        x, y, z = x + 1e-12 * altitude, y + (sin_lat + cos_lat), z + (sin_lon + cos_lon)
    store(state, 8, x + y + z)


@entry
def _density(count, state, model, factors, scratch):
    altitude, sine, cosine = splat(4e5), splat(0.6), splat(0.8)
    for _ in range(count):
        rho = dtm2000.density(
            altitude, sine, cosine, sine, cosine, sine, cosine, model.thermosphere, factors, scratch
        )
        altitude = altitude + rho
    store(state, 8, altitude)


@entry
def _drag(count, state, values):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    rho, turning = splat(1e-12), (values[SPIN], values[SPIN + 1], values[SPIN + 2])
    for _ in range(count):
        ax, ay, az = drag(x, y, z, vx, vy, vz, turning, rho, load(state, 6))
        vx, vy, vz = vx + ax, vy + ay, vz + az
    store(state, 8, vx + vy + vz)


@entry
def _pressure(count, state, values, scratch):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    for _ in range(count):
        r2 = x * x + y * y + z * z
        lit = illumination(x, y, z, r2, values[SUN_ITRF : SUN_ITRF + 3], scratch)
        ax, ay, az = radiation_pressure(x, y, z, values[BODIES : BODIES + 3], lit, load(state, 7))
        x, y, z = x + ax, y + ay, z + az
    store(state, 8, x + y + z)


@entry
def _acceleration(count, state, model, values, factors, scratch):
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    for _ in range(count):
        ax, ay, az, _, _ = acceleration(
            x, y, z, vx, vy, vz, load(state, 6), load(state, 7), splat(0.0), model, values, factors, scratch
        )
        x, y, z = x + ax, y + ay, z + az
    store(state, 8, x + y + z)


@entry
def _look_up(count, t, model, values, factors):
    for k in range(count):
        look_up(t + 8.0 * k, model, values, factors)


@entry
def _reduce(count, model, factors):
    for k in range(count):
        dtm2000.reduce_to_date(model.thermosphere, model.seasons[0], 80.0 + k, 80.0, 2.0, 2.0, factors)


@entry
def _step(count, t, state, new, coefficients, model, values, factors, scratch, slopes, error):
    for k in range(count):
        dop853.step(t + 90.0 * k, 90.0, state, new, model, coefficients, values, factors, scratch, slopes)
        store(error, 0, dop853.error(90.0, new, slopes, 0.1, model.gm))


@dataclass(frozen=True)
class Timing:
    """A kernel's time [ns] and arithmetic for one arc; shared work is divided among the lanes."""

    name: str
    nanoseconds: float
    work: Work | None = None


def timings() -> list[Timing]:
    """Time every kernel of an evaluation under the assumed model, and what differs under the true one."""
    assumed, true = case.force_model("assumed"), case.force_model("truth")
    state, scratch, slopes = rows(9), rows(SCRATCH_ROWS), rows(RATES * (dop853.STAGES + 1))
    state[:6] = case.arcs(WIDTH).states.T
    state[6], state[7] = 0.11, 0.0625
    values, factors = surroundings.allocate(assumed)
    true_values, true_factors = surroundings.allocate(true)
    _look_up(1, DAY, assumed, values, factors)
    _look_up(1, DAY, true, true_values, true_factors)

    def time(kernel: Callable, *arguments: object, count: int = 500) -> float:
        kernel(1, *arguments)
        seconds = measure.best(lambda: kernel(count, *arguments), repeats=_REPEATS)
        return 1e9 * seconds / count / WIDTH

    start, coefficients = rows(6), rows(3)
    start[:], coefficients[:2] = state[:6], state[6:8]
    workspace = (assumed, values, factors, scratch, slopes, rows(1))
    step = time(_step, DAY, start, rows(6), coefficients, *workspace, count=60) / EVALUATIONS
    acceleration = time(_acceleration, state, assumed, values, factors, scratch)
    shared = time(_look_up, DAY, assumed, values, factors)
    per_evaluation = shared * (EVALUATIONS - 1) / EVALUATIONS
    return [
        Timing("gravity, 20x20", time(_gravity, state, assumed), gravity_work(assumed)),
        Timing("gravity, 40x40", time(_gravity, state, true), gravity_work(true)),
        Timing("third bodies, 3", time(_third_bodies, state, assumed, values), third_body_work(assumed)),
        Timing("third bodies, 10", time(_third_bodies, state, true, true_values), third_body_work(true)),
        Timing("geodetic coordinates", time(_geodetic, state), GEODETIC),
        Timing("DTM2000 density", time(_density, state, assumed, factors, scratch), density_work()),
        Timing("drag", time(_drag, state, values), DRAG),
        Timing("illumination and pressure", time(_pressure, state, values, scratch), PRESSURE),
        Timing("all forces together, 20x20", acceleration, _sum_of_forces(assumed)),
        Timing("look-up, shared by 16 lanes", per_evaluation),
        Timing("of which DTM2000's date and activity", time(_reduce, assumed, factors)),
        Timing("Runge-Kutta sums, error estimate, calls", step - acceleration - per_evaluation, stage_work()),
        Timing("a step, for each of its 12 evaluations", step),
    ]


def _sum_of_forces(model):
    parts = [gravity_work(model), third_body_work(model), GEODETIC, density_work(), DRAG, PRESSURE, REST]
    return Work(
        *(sum(getattr(part, name) for part in parts) for name in Work.__dataclass_fields__),
    )


def report() -> str:
    """Return the processor's peak and the table of kernels, in Markdown."""
    found = machine()
    text = (
        f"One thread does a fused instruction on 8 doubles in {found.fused:.3f} ns at best "
        f"({0.5 / found.fused:.2f} GHz with two units), {found.peak:.0f} multiplications and additions a "
        f"nanosecond; a division on 8 doubles takes {found.division:.2f} ns, a root {found.root:.2f} ns.\n\n"
    )
    lines = []
    for timing in timings():
        cells = [timing.name, *["-"] * 6]
        if timing.work:
            least, work = found.least(timing.work), timing.work
            cells[1:4] = f"{work.operations}", f"{work.instructions}", f"{work.divisions} + {work.roots}"
            cells[4] = measure.figures(least)
            cells[6] = f"{100.0 * work.operations / timing.nanoseconds / found.peak:.0f} %"
        cells[5] = measure.figures(timing.nanoseconds)
        lines.append(cells)
    headings = [
        "kernel, per arc and evaluation",
        "x and +",
        "instructions",
        "divisions + roots",
        "these take [ns]",
        "measured [ns]",
        "of the peak",
    ]
    return text + measure.table(headings, lines)


if __name__ == "__main__":
    print(report())
