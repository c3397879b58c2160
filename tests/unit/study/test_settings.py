"""Settings: the paper's are valid, and each wrong one is told in one line with its file and key."""

import json
import shutil
from dataclasses import replace
from functools import cache

import pytest
import yaml
from element_histories import history, tle_text
from jsonschema import Draft202012Validator
from laser_files import LASER
from support import (
    EXCERPTS,
    REPOSITORY,
    paper_source,
    paper_values,
    refusal,
    refusals,
    setting_keys,
    study_of,
)

from opml.base.errors import InputError
from opml.base.files import PACKAGED
from opml.base.yaml_files import read_yaml
from opml.catalog import kinds
from opml.dynamics.settings import Integrator
from opml.study import checks
from opml.study.experiments import Study
from opml.study.settings import editor_schema
from opml.study.settings.json_schema import json_schema
from opml.study.settings.merging import merged, with_sheets
from opml.study.settings.model import study_parts
from opml.study.settings.model.whole import RunSettings
from opml.study.settings.overlay import COMMAND_LINE, Layer, Source, laid_over, with_numbers

PAPER = paper_source().values


@pytest.fixture(autouse=True)
def _in_root(monkeypatch):
    monkeypatch.chdir(REPOSITORY)  # the sheets' paths are relative to it


def edited(key, value):
    values = paper_source().values
    *parents, last = key.split(".") if isinstance(key, str) else key
    place = values
    for name in parents:
        place = place.setdefault(name, {})
    place[last] = value
    return values


def checked(source):
    """Settings as the plan takes them."""
    settings = checks.load_settings(source)
    checks.check_data(source, settings)
    return settings


def refused(source):
    """The one line with which settings are refused."""
    return refusal(checked, source)


def message(values):
    return refused(Source(values, paper_source().layers))


def given(tmp_path, text, **command_line):
    """Settings of a file of one's own, laid over the paper's."""
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    return merged(["config/config.yaml", path], Layer(COMMAND_LINE, command_line))


def test_papers_settings_are_valid():
    settings = checks.load_settings(paper_source())
    assert settings.values == PAPER
    assert (len(settings.stations), len(settings.rsos)) == (3, 7)


def test_every_setting_of_another_type_is_told_with_its_key():
    for key in setting_keys():
        said = message(edited(key, [[]]))
        assert said.startswith(f"--config: {'.'.join(key)}"), said


def objects(node):
    """Every mapping of a schema."""
    if isinstance(node, dict):
        if node.get("type") == "object":
            yield node
        for part in node.values():
            yield from objects(part)


def test_no_object_of_the_schema_takes_unknown_keys():
    # A learner's keys depend on its kind: each kind's own object is closed.
    assert all({"additionalProperties", "allOf"} & set(found) for found in objects(json_schema(RunSettings)))


def test_defaults_of_the_library_are_those_of_the_models():
    assert Integrator() == Integrator(**PAPER["integrator"])
    defaults = study_of(paper_values() | {"study": {}}).defaults
    for name in ("learner", "component"):
        assert defaults[name] == study_parts.Defaults.model_fields[name].default


@pytest.fixture(scope="module")
def editor(tmp_path_factory):
    """What an editor holds a file of settings against: the schema that is written."""
    project = tmp_path_factory.mktemp("project")
    editor_schema.write(project)
    return Draft202012Validator(json.loads((project / editor_schema.PLACE).read_text(encoding="utf-8")))


@pytest.mark.parametrize("path", sorted((REPOSITORY / "config").rglob("*.yaml")), ids=lambda path: path.stem)
def test_an_editor_takes_every_file_of_settings(editor, path):
    Draft202012Validator.check_schema(editor.schema)
    assert [error.message for error in editor.iter_errors(read_yaml(path))] == []


@pytest.mark.parametrize(
    ("text", "is_taken"),
    [
        ("study: {}", True),
        ("study: null", True),
        ("study: paper", True),
        ("learners: {svr: {c: 2}}", True),
        ("learners: {svr: {kind: svr, d: 2}}", False),
        ("learners: {mine: {kind: refitted, window_hours: 0}}", False),
        ("study: {evaluations: {mine: {claims: [{says: it is small}]}}}", False),
        ("tracking: {step: 20}", False),
        ("tracking: {step_s: '20'}", False),
    ],
)
def test_an_editor_asks_for_no_key_that_config_yaml_has(editor, text, is_taken):
    assert editor.is_valid(yaml.safe_load(text)) is is_taken


def test_the_typed_run_has_the_values():
    typed = checks.load_settings(paper_source()).run
    assert typed.estimation.model_dump(exclude_unset=True) == PAPER["estimation"]
    assert typed.learners["boosting"].trees == PAPER["learners"]["boosting"]["trees"]
    assert typed.study.evaluations["future_5days"].train == "days-0-30"
    assert typed.model_dump(mode="json", by_alias=True, exclude_unset=True, serialize_as_any=True) == PAPER


@pytest.mark.parametrize(("key", "value", "expected"), refusals("settings"))
def test_wrong_setting_is_named(key, value, expected):
    assert expected in message(edited(key, value))


@pytest.mark.parametrize("kind", ["tracks", "fixes"])
def test_what_was_measured_and_has_no_truth_learns_from_later_estimates(kind):
    source = paper_source()
    source.values[kind] = {"iss": ["a.file"]}
    source.values["study"] = {"rsos": ["iss"], "days": {"train": [0, 30], "test": [30, 40]}}
    settings = with_sheets(source.values)
    checks.check_study(source, settings)
    assert Study(settings).label == "later"
    source.values["study"]["label"] = "truth"
    with pytest.raises(InputError, match=r"study\.label: expected later, as iss was measured"):
        checks.check_study(source, settings)
    source.values["orbits"] = {"iss": ["an.orbit"]}
    checks.check_study(source, with_sheets(source.values))


def test_missing_setting_is_named():
    values = paper_source().values
    del values["prediction"]["max_days"]
    assert message(values) == "config/config.yaml: prediction.max_days: expected a value, got none"


def test_key_that_is_no_text_is_named():
    assert "3: expected a key that is text" in message(PAPER | {3: 4})


def test_the_file_that_set_the_value_is_named(tmp_path):
    assert refused(given(tmp_path, "tracking: {step_s: -1}\n")).startswith(
        f"{tmp_path}/mine.yaml: tracking.step_s"
    )
    on_top = given(tmp_path, "tracking: {step_s: 1}\n", tracking={"step_s": -1})
    assert refused(on_top).startswith("--config: tracking.step_s")
    study = "study: {extends: [paper], partition: {ratios: [0]}}\n"
    assert refused(given(tmp_path, study)).startswith(f"{tmp_path}/mine.yaml: study.partition.ratios.0")


@pytest.mark.parametrize("text", ["a: [", "a: b: c", "\t- x", "!!python/object:os.system {}"])
def test_what_is_no_yaml_is_named_and_nothing_is_run(tmp_path, text):
    file = tmp_path / "broken.yaml"
    file.write_text(text)
    assert "broken.yaml: expected YAML" in refusal(read_yaml, file)


def test_numbers_inside_braces_on_the_command_line_become_numbers():
    given = {"a": {"b": "20", "c": ["0.5", "x"], "d": True}, "e": 0.5}
    assert with_numbers(given) == {"a": {"b": 20, "c": [0.5, "x"], "d": True}, "e": 0.5}
    assert isinstance(with_numbers(given)["a"]["b"], int)
    assert with_numbers(given)["a"]["d"] is True


OWN = """
study:
  rsos: [lares]
  station_sets: [eglin-kaena]
  days: {train: [0, 8], test: [8, 12]}
"""


def test_a_study_of_ones_own_has_nothing_of_the_papers(tmp_path):
    source = given(tmp_path, OWN)
    assert set(source.values["study"]) == {"rsos", "station_sets", "days"}
    assert checks.load_settings(source).study == source.values["study"]


def test_a_study_that_extends_others_is_laid_over_them(tmp_path):
    study = given(tmp_path, "study: {extends: [paper], partition: {ratios: [20]}}\n").values["study"]
    assert study["partition"] == PAPER["study"]["partition"] | {"ratios": [20]}
    assert study["curves"] == PAPER["study"]["curves"]
    assert "splits" not in study


def test_a_study_may_be_a_file_elsewhere(tmp_path):
    (tmp_path / "other.yaml").write_text(OWN)
    study = given(tmp_path, f"study: [{tmp_path}/other.yaml]\n").values["study"]
    assert study["rsos"] == ["lares"]


@pytest.mark.parametrize("nothing", ["{}", "null"])
def test_no_study_is_no_study(tmp_path, nothing):
    source = given(tmp_path, f"study: {nothing}\n")
    assert checks.load_settings(source).study == {}


MISFIT = (
    "config/studies/paper.yaml: study.span_days: expected ascending days up to duration_days, 27, "
    'got 0 and 30; "study: {}" in a file, or --config study={}, asks for no study'
)


def test_a_run_may_be_too_short_for_a_study_that_nobody_asked_for(tmp_path):
    assert checks.load_settings(given(tmp_path, "duration_days: 27")).misfit == MISFIT
    assert checks.load_settings(given(tmp_path, "", duration_days=27)).misfit == MISFIT
    assert checks.load_settings(given(tmp_path, "study: {}", duration_days=27)).misfit == ""
    assert checks.load_settings(given(tmp_path, "duration_days: 60")).misfit == ""


def test_what_else_is_wrong_with_the_default_study_of_a_short_run_is_told(tmp_path):
    sheet = (REPOSITORY / "config" / "rsos.tsv").read_text().replace("iss\t", "sky01\t")
    (tmp_path / "sky.tsv").write_text(sheet)
    line = refused(given(tmp_path, f"duration_days: 27\nsheets: {{rsos: {tmp_path / 'sky.tsv'}}}\n"))
    assert "study.defaults.rso: RSO 'iss': expected one of sky01" in line


@pytest.mark.parametrize(("text", "expected"), refusals("settings_of_ones_own"))
def test_wrong_file_of_ones_own_is_named(tmp_path, text, expected):
    assert expected in refusal(lambda: checked(given(tmp_path, text + "\n")))


def test_a_study_that_extends_itself_is_named(tmp_path):
    (tmp_path / "ring.yaml").write_text(f"study: {{extends: [{tmp_path}/ring.yaml]}}\n")
    with pytest.raises(InputError, match="expected studies that do not extend themselves"):
        given(tmp_path, f"study: [{tmp_path}/ring.yaml]\n")


def test_a_run_is_not_extended(tmp_path):
    (tmp_path / "run.yaml").write_text("epoch: '2016-09-28T12:09:45'\n" + OWN)
    with pytest.raises(InputError, match=r"run\.yaml: epoch: expected nothing but a study here"):
        given(tmp_path, f"study: [{tmp_path}/run.yaml]\n")


def test_rows_of_ones_own_join_the_sheets(tmp_path):
    row = "{a_km: 6900, e: 0.001, i_deg: 97.5, argp_deg: 0, raan_deg: 120, mean_anomaly_deg: 0, "
    text = (
        f"rsos: {{mine: {row} area_to_mass_m2pkg: 0.02, cd: 2.2, cr: 1.25}}}}\nstudy: {{rsos: [mine_i50]}}\n"
    )
    settings = checks.load_settings(given(tmp_path, text))
    assert settings.rsos["mine"].a == 6900e3
    assert list(settings.rsos)[-1] == "mine"


def test_an_orbit_of_ones_own_needs_the_body_only(tmp_path):
    (tmp_path / "b.sp3").write_text("")
    (tmp_path / "a.sp3").write_text("")
    text = f"""
data: {tmp_path}
orbits: {{mine: "*.sp3"}}
rsos: {{mine: {{area_to_mass_m2pkg: 0.01, cd: 2.2, cr: 1.3}}}}
study: {{rsos: [mine]}}
"""
    settings = checks.load_settings(given(tmp_path, text))
    assert settings.orbits == {"mine": [f"{tmp_path}/a.sp3", f"{tmp_path}/b.sp3"]}
    assert settings.rsos["mine"].area_to_mass == 0.01
    assert settings.rsos["mine"].a != settings.rsos["mine"].a  # not known, and not asked for
    line = refused(given(tmp_path, text.replace("orbits: {mine", "orbits: {iss")))
    assert "rsos.mine: expected the keys a_km, e," in line


BURNS = """\
SATCAT number: 25544
manoeuvre_timestamps:
- 2016-09-29 01:00:00
name: mine
"""
GPS = """\
gps,x_itrf_km,y_itrf_km,z_itrf_km
2016-09-28T12:10:20,6700.0,0.0,0.0
2016-09-28T12:11:20,6685.0,450.0,0.0
"""
TLE = """\
1 25544U 98067A   16270.55892361  .00003421  00000-0  59245-4 0  9994
2 25544  51.6447 263.7421 0006793 345.4559  14.5438 15.54019233 20745
"""
TAKEN = "{coordinates: coordinates.snx, eccentricities: eccentricities.snx, reflectors_m: 0.25}"
MEASURED = {
    "tracks": "tracks: {mine: a.tdm}",
    "fixes": "fixes: {mine: gps.csv}",
    "elements": "elements: {mine: sets.tle}\nday: {messages: [mine]}",
    "ranges": f"ranges: {{mine: lageos.crd}}\nstarts: {{mine: mine.tle}}\nranging: {{mine: {TAKEN}}}",
}


@cache
def sets_of(numbers=(25544,), days=(1, 2, 3, 4)):
    """TLEs of objects at days since the epoch."""
    return "".join(tle_text(history(days), number) for number in numbers)


def measured(folder, kind, *lines, replaced=(), edit=()):
    """Settings of a run that measured `mine`, and further lines, once the files that they name are there.

    replaced: a text of the settings, and that in its place; edit: a file, and the same of it
    """
    files = LASER | {
        "a.tdm": (EXCERPTS / "orekit.tdm").read_text(),
        "burns.yaml": BURNS,
        "gps.csv": GPS,
        "mine.tle": TLE,
        "sets.tle": sets_of(),
    }
    if edit:
        name, old, new = edit
        assert old in files[name]
        files[name] = files[name].replace(old, new)
    body = "rsos: {mine: {area_to_mass_m2pkg: 0.01, cd: 2.2, cr: 1.3}}"
    text = "\n".join([f"data: {folder}", MEASURED[kind], body, "study: {}", *lines])
    if replaced:
        old, new = replaced
        assert old in text
        text = text.replace(old, new)
    for name in files:
        if name in text:
            (folder / name).write_text(files[name])
    return given(folder, text)


def study_of_mine(settings):
    """The study of all that is usual of what was measured."""
    return Study(replace(settings, values=settings.values | {"study": {"rsos": ["mine"]}}))


@pytest.mark.parametrize(("kind", "lines", "replaced", "edit", "said"), refusals("settings_of_measured"))
def test_what_was_measured_and_does_not_fit_is_told_in_one_line(tmp_path, kind, lines, replaced, edit, said):
    line = refused(measured(tmp_path, kind, *lines, replaced=replaced, edit=edit))
    assert said.replace("{folder}", str(tmp_path)) in line
    assert line.startswith(f"{tmp_path}/mine.yaml: ")


@pytest.mark.parametrize(
    ("kind", "lines", "station_set"),
    [("fixes", ['manoeuvres: {mine: ["2016-09-29T01:00:00"]}'], "fixes"), ("ranges", [], "ranges")],
)
def test_other_measurements_stand_where_tracks_do_and_no_station_of_the_sheet_made_them(
    tmp_path, kind, lines, station_set
):
    settings = checked(measured(tmp_path, kind, *lines))
    file = {"fixes": "gps.csv", "ranges": "lageos.crd"}[kind]
    asked = next(one for one in kinds.KINDS if one.name == kind)
    assert settings.files_of(asked) == settings.measured == {"mine": [f"{tmp_path}/{file}"]}
    study = study_of_mine(settings)
    assert (study.station_sets, study.label, study.truth_of("mine")) == ([station_set], "later", "measured")


def test_tracks_of_ones_own_need_the_body_only(tmp_path):
    lines = "starts: {mine: mine.tle}", 'manoeuvres: {mine: ["2016-09-29T01:00:00"]}'
    settings = checked(measured(tmp_path, "tracks", *lines))
    assert settings.files_of(kinds.TRACKS) == {"mine": [f"{tmp_path}/a.tdm"]}
    assert settings.starts == {"mine": f"{tmp_path}/mine.tle"}
    assert settings.rsos["mine"].a != settings.rsos["mine"].a  # not known, and not asked for


@pytest.mark.parametrize("content", ["", "Not found\n", "\0" * 99, "CCSDS_TDM_VERS = 2.0\n", "\udcff"])
def test_files_that_hold_no_tracks_are_told(tmp_path, content):
    source = measured(tmp_path, "tracks")
    (tmp_path / "a.tdm").write_text(content, errors="surrogateescape")
    line = refused(source)
    assert f"tracks.mine: {tmp_path}/a.tdm: " in line
    assert "expected " in line


def test_an_orbit_beside_tracks_judges(tmp_path, monkeypatch):
    monkeypatch.setattr(checks.orbit_from_files, "read_arcs", lambda *_, **__: None)
    study = study_of_mine(checked(measured(tmp_path, "tracks", "orbits: {mine: a.tdm}")))
    assert (study.label, study.truth_of("mine"), study.is_measured("mine")) == ("later", "files", True)


def test_fixes_are_weighed_as_the_settings_say(tmp_path):
    settings = checked(measured(tmp_path, "fixes", "fixing: {mine: {sigma_m: [2, 4, 2], every_s: 0}}"))
    fixing = settings.options(kinds.FIXES, "mine")
    assert (fixing.sigmas, fixing.every_s, fixing.stretch_hours) == ((2.0, 4.0, 2.0), 0.0, 1.0)


def test_laser_ranges_bring_stations_of_their_own(tmp_path):
    settings = checked(measured(tmp_path, "ranges"))
    sites = [f"{tmp_path}/{name}.snx" for name in ("coordinates", "eccentricities")]
    assert settings.companion_files(kinds.RANGES) == {"mine": sites}
    ranging = settings.options(kinds.RANGES, "mine")
    assert (ranging.reflectors_m, ranging.sigma_m) == (0.25, 0.02)
    elements = "a_km: 12271, e: 0, i_deg: 110, argp_deg: 0, raan_deg: 0, mean_anomaly_deg: 0, area"
    source = measured(tmp_path, "ranges", replaced=["area", elements])
    del source.values["starts"]
    checked(source)


def test_sets_are_of_the_object_that_the_settings_say(tmp_path):
    settings = checked(measured(tmp_path, "elements", "histories: {mine: {number: 25544}}"))
    assert settings.options(kinds.ELEMENTS, "mine").number == 25544
    assert settings.options(kinds.ELEMENTS, "iss").number is None


def test_manoeuvres_may_stand_in_a_file(tmp_path):
    settings = checked(measured(tmp_path, "fixes", "manoeuvres: {mine: burns.yaml}"))
    assert settings.manoeuvres("mine") == ["2016-09-29T01:00:00"]
    assert settings.manoeuvre_files == {"mine": f"{tmp_path}/burns.yaml"}
    assert settings.manoeuvres("iss") == []


def test_messages_are_of_objects_that_were_measured(tmp_path):
    for messages in ("[]", "[mine]"):
        checked(measured(tmp_path, "elements", replaced=["[mine]", messages]))


def test_no_learner_of_telescopes_asks_for_what_radars_measure(tmp_path):
    row = "latitude_deg: 20, longitude_deg: 0, altitude_m: 0, max_range_km: 50000, min_elevation_deg: 10"
    text = f"stations: {{tenerife: {{{row}, max_elevation_deg: 90, sigma_declination_deg: 0.001}}}}\n"
    text += "study: {rsos: [iss], station_sets: [eglin-tenerife]}\n"
    learner = "learners: {boosting: {variables: [duration, elevation_max]}}"
    checked(given(tmp_path, text))
    expected = "expected variables that eglin-tenerife have, too, got elevation_max"
    assert f"learners.boosting.variables: {expected}" in refused(given(tmp_path, f"{text}{learner}\n"))


def test_layers_are_laid_key_by_key():
    base = {"a": {"b": 1, "c": [1, 2]}, "d": 3}
    assert laid_over(base, {"a": {"c": [3]}}) == {"a": {"b": 1, "c": [3]}, "d": 3}
    assert laid_over(base, {"a": {}}) == {"a": {}, "d": 3}
    assert laid_over(base, {"a": None}) == {"a": None, "d": 3}
    assert base == {"a": {"b": 1, "c": [1, 2]}, "d": 3}


def test_a_value_of_no_file_is_the_command_lines():
    source = Source({"a": 1}, [Layer("file.yaml", {"a": 2})])
    assert str(source.wrong(("a",), "expected 3")) == "--config: a: expected 3"


@pytest.mark.parametrize(("first", "second", "expected"), refusals("settings_in_two_files"))
def test_the_file_in_which_a_wrong_value_stands_is_named(tmp_path, monkeypatch, first, second, expected):
    files = [REPOSITORY / "config" / "config.yaml", tmp_path / "a.yaml", tmp_path / "b.yaml"]
    files[1].write_text(first)
    files[2].write_text(second)
    assert refused(merged(files, Layer(COMMAND_LINE, {}))).startswith(f"{tmp_path}/{expected}")


def test_a_file_in_the_place_of_results_is_told(tmp_path):
    (tmp_path / "taken").write_text("")
    for results in ("taken", "taken/deeper"):
        line = refused(given(tmp_path, f"results: {tmp_path}/{results}"))
        assert line.endswith(f"mine.yaml: results: expected a folder, got a file at {tmp_path}/taken")


def test_a_sheet_that_the_project_lost_is_told(tmp_path, monkeypatch):
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    (tmp_path / "config" / "stations.tsv").unlink()
    monkeypatch.chdir(tmp_path)
    line = "config/config.yaml: sheets.stations: config/stations.tsv: no such file"
    assert refused(merged(["config/config.yaml"])) == line
    checks.load_settings(merged([PACKAGED]))  # settings of the package have its sheets
