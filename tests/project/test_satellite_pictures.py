"""The pictures of real satellites: which rows of a finished study they compare."""

import numpy as np
import pytest
from mornings import replays

from validation.pictures import satellite_figures as figures
from validation.pictures.real_satellites import NAMES, Satellite


@pytest.fixture
def satellite(tmp_path, monkeypatch):
    """A study of Swarm A whose models leave different shares of one error."""
    shares = {"fit48": 0.5, "running24": 0.3, "mechanism": 0.4}
    tables = {name: (table := replays()).assign(e_y=share * table["e_y"]) for name, share in shares.items()}
    monkeypatch.setattr(Satellite, "replay", lambda self, name: tables.get(name, replays()))
    return Satellite.read("swarm", tmp_path)


def test_every_study_is_of_a_satellite_with_a_name(tmp_path):
    names = [Satellite.read(name, tmp_path).name for name in NAMES]
    assert names == ["Swarm A", "Larets", "Sentinel-3A", "LAGEOS-2"]


def test_the_best_without_learning_and_the_choice_stand_beside_no_correction(satellite):
    tables = satellite.tables
    assert set(tables) == {figures.BEFORE, figures.PLAIN, figures.CHOSEN}
    assert len({len(table) for table in tables.values()}) == 1
    plain, before = tables[figures.PLAIN], tables[figures.BEFORE]
    assert np.allclose(plain["e_y"], 0.3 * before["e_y"] / 50.0)


def test_another_model_is_compared_on_the_same_predictions(satellite):
    assert len(satellite.beside(replays())) == len(satellite.tables[figures.CHOSEN]) < len(replays())
