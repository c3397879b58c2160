"""Identifiers of an object in space: international designator and catalogue number before the name.

Fragments of a break-up share their name, and a designator is written with or without the century and dashes.
"""

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from sgp4.alpha5 import from_alpha5

from opml.base.files import FilePath
from opml.tables import read_metadata

_DESIGNATOR = re.compile(r"(\d{4}|\d{2})-?(\d{3})-?([A-Z]{1,3})", re.ASCII)
_NUMBER = re.compile(r"\d{1,9}", re.ASCII)
_ALPHA_5 = re.compile(r"[A-HJ-NP-Z]\d{4}", re.ASCII)  # a number as TLEs have it
_FIRST_YEAR = 57  # two digits of the year of the first launch
_UNKNOWN = ("", "UNKNOWN", "NONE", "N/A")


@dataclass(frozen=True)
class ObjectId:
    """An object, as a file names it.

    designator: international, as 1998-067A, or whatever else the file has for one; '' where unknown
    """

    name: str  # many objects may share it
    designator: str = ""
    number: int = 0  # of the catalogue, 0 where unknown

    @classmethod
    def of(cls, name: str, *identifiers: str) -> "ObjectId":
        """Return the object of a name and of what its file has for designator or number, in any order."""
        designator, number = "", 0
        for text in map(str.strip, identifiers):
            if _NUMBER.fullmatch(text):
                number = int(text)
            elif text.upper() not in _UNKNOWN and text != name:
                designator = _normal(text.upper())
        return cls(name, designator, number)

    @classmethod
    def of_word(cls, word: str) -> "ObjectId":
        """Return the object of a file's one word for it: a designator, a catalogue number or a name."""
        is_identifier = _DESIGNATOR.fullmatch(word.upper()) or _NUMBER.fullmatch(word)
        return cls.of("", word) if is_identifier else cls(word)

    @property
    def identifier(self) -> str:
        """International designator, else catalogue number; '' where neither is known."""
        return self.designator or (str(self.number) if self.number else "")

    @property
    def launch(self) -> str:
        """International designator as TLEs have it, 98067A; '' where there is none."""
        match = _DESIGNATOR.fullmatch(self.designator)
        return f"{match[1][-2:]}{match[2]}{match[3]}" if match else ""

    def is_called(self, wanted: str) -> bool:
        """Return whether a user's word is its number, as A0001 and 00005, too, its name or designator."""
        words = {_normal(wanted.upper()), wanted.upper()}
        if _NUMBER.fullmatch(wanted) or _ALPHA_5.fullmatch(wanted.upper()):
            words.add(str(from_alpha5(wanted.upper())))
        words -= {"", "0"}
        return not words.isdisjoint({str(self.number), self.name.upper(), self.designator.upper()})

    def is_same(self, other: "ObjectId") -> bool:
        """Return whether both are one object; names decide only where either has nothing else."""
        if known := self._agreements(other):
            return all(known)
        either_is_bare = not (self.designator or self.number) or not (other.designator or other.number)
        return either_is_bare and self.name == other.name

    def is_another(self, other: "ObjectId") -> bool:
        """Return whether designators or numbers of both are known, and differ."""
        return not all(self._agreements(other))

    def _agreements(self, other: "ObjectId") -> list[bool]:
        pairs = ((self.designator, other.designator), (self.number, other.number))
        return [one == another for one, another in pairs if one and another]

    def __str__(self) -> str:
        """Name, with an identifier that distinguishes objects of that name."""
        known = [str(one) for one in (self.number, self.designator) if one and str(one) != self.name]
        return f"{self.name} ({', '.join(known)})" if known else self.name


UNKNOWN = ObjectId("")  # an object of which nothing is known


def facts(identity: ObjectId) -> dict[str, Any]:
    """Return what a table's metadata show about its object."""
    return {"object": asdict(identity)}


def most_specific(identities: Sequence[ObjectId]) -> ObjectId:
    """Return the first object of which more than the name is known, else the last, UNKNOWN of none."""
    return next((one for one in identities if one.identifier), [UNKNOWN, *identities][-1])


def of_tables(paths: Sequence[FilePath], *, name: str) -> ObjectId:
    """Return the object that the metadata of some tables name, the first that do, under another name."""
    identities = [ObjectId(**read_metadata(path).get("object", {"name": ""})) for path in paths]
    return replace(most_specific(identities), name=name)


def _normal(text: str) -> str:
    """Return an international designator as 1998-067A, any other text as it is."""
    if not (match := _DESIGNATOR.fullmatch(text)):
        return text
    year = match[1]
    if len(year) == 2:
        year = f"{19 if int(year) >= _FIRST_YEAR else 20}{year}"
    return f"{year}-{match[2]}{match[3]}"
