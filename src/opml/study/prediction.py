"""An object's prediction from whatever tells its orbit: element sets, points or tracks."""

from opml.base.files import PROJECT
from opml.base.progress import Progress
from opml.base.yaml_files import read_yaml
from opml.interop.predicted_orbit import PredictedOrbit
from opml.learning.data import error_components
from opml.learning.models import learners
from opml.mornings import prediction
from opml.mornings.prediction_request import OrbitSettings, Request
from opml.study.settings import packaged
from opml.study.settings.model.run import DaySettings

MODELS = ("fit48", "running24", "running24m3")
"""Models that the past chooses from: those of every morning whose fits are short."""

FIELD = {"degree": 48, "order": 48}
"""Of gravity: 70x70 takes shorter steps and twice the time, and predicts Swarm A about as well."""

CD_SIGMA = 2.0  # of Cd about 2.2: one track may say nothing of drag, or anything; area to mass may be a guess

STEP = 120.0  # longest step [s]: this field is followed as closely as the finer one in 75 s


def of_measurements(request: Request, *, progress: Progress) -> PredictedOrbit:
    """Predict an object from points or tracks as mornings do; raises as `mornings.prediction.predict`."""
    return prediction.predict(request, settings(), progress=progress)


def settings() -> OrbitSettings:
    """Return the settings of mornings that come with the package, for real objects."""
    run = packaged.RUN
    real = read_yaml(PROJECT / "config" / "real_satellites.yaml")
    component, variables = error_components.CORRECTED, run["learning"]["variables"]
    models = {name: learners.settings_of(run["learners"][name]) for name in MODELS}
    return OrbitSettings(
        estimation=run["estimation"] | {"cd_sigma": CD_SIGMA},
        force_model=real["force_models"]["assumed"] | FIELD,
        integrator=run["integrator"] | {"max_step_s": STEP},
        environment=run["environment"],
        futures=DaySettings().futures,
        models={name: m.resolved(component=component, variables=variables) for name, m in models.items()},
    )
