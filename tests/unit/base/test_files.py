"""Files and folders take their names when they are complete."""

import pytest

from opml.base.files import replacing_folder


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


def test_a_folder_takes_the_place_of_an_earlier_one_and_all_in_it(tmp_path):
    for name in ("first", "second"):
        with replacing_folder(tmp_path / "made" / "here") as new:
            (new / name).write_text(name)
            assert names(tmp_path / "made" / "here") == ([] if name == "first" else ["first"])
    assert names(tmp_path) == ["made", "made/here", "made/here/second"]


@pytest.mark.parametrize("earlier", [True, False])
def test_a_folder_that_is_not_completed_changes_nothing(tmp_path, earlier):
    if earlier:
        (tmp_path / "here").mkdir()
        (tmp_path / "here" / "first").touch()
    before = names(tmp_path)

    def write_half():
        with replacing_folder(tmp_path / "here") as new:
            (new / "second").touch()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_half()
    assert names(tmp_path) == before
