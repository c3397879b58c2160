"""Types of settings that are names, windows of days, splits and paths."""

from typing import Annotated, Literal

from annotated_types import Ge, Le, MinLen
from pydantic import Field, Strict

from opml import naming
from opml.base.section import Placeholder
from opml.base.setting_types import Count, Expected, OneOf, Positive, Text, Unique
from opml.learning.models.contract import Variable
from opml.tables import COMPONENTS

Name = Annotated[
    str,
    Field(pattern="^[a-z][a-z0-9]{0,59}$"),
    Expected("a name of up to 60 lower-case letters and digits"),
    Placeholder("name"),
]

EntryName = Annotated[
    str,
    Field(pattern="^[a-z][a-z0-9_]{0,59}$"),
    Expected("a name of up to 60 lower-case letters, digits and _"),
    Placeholder("name"),
]

FigureName = Annotated[EntryName, Placeholder("figure")]

RsoName = Annotated[str, Placeholder("rso")]

CurveName = Annotated[
    str,
    Field(pattern="^(?:inclination|semi_major_axis)$"),
    Expected("inclination or semi_major_axis"),
    Placeholder("curve"),
]

Folder = Annotated[
    str,
    # Snakemake reads braces as wildcards, and shells end a word at a space.
    Field(pattern=r"^(?!~)[\w./~+@-]*[\w~+@-]$", max_length=200),
    Expected("a folder's path of at most 200 letters without spaces, braces or a leading ~"),
]

PathList = Annotated[
    Text | Annotated[list[Text], MinLen(1)], Expected("a file's path, a pattern of paths, or a list of them")
]

Epoch = Annotated[
    str,
    Field(pattern=r"^\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}(\.\d+)?$"),
    Expected('UTC text in quotes, like "2016-09-28T12:09:45"'),
]

Times = Annotated[
    Text | list[str], Expected("a list of UTC texts in quotes, or the path of a YAML file with such a list")
]

Names = Annotated[list[str], MinLen(1), Unique(), Expected("a list of names")]


Seed = Annotated[int, Ge(0), Expected("a whole number from 0")]

SeedList = Annotated[list[Seed], MinLen(1), Unique(), Expected("a list of seeds")]

Variables = Annotated[list[Variable], MinLen(1), Unique()]

Component = Annotated[str, OneOf(COMPONENTS)]

Label = Annotated[str, OneOf(tuple(naming.LABELS)), Expected("truth or later")]

Fence = Annotated[Literal["dataset", "none"] | Positive, Expected("dataset, none or a number above 0")]

Holds = Annotated[
    str,
    OneOf(
        (
            *("below", "above", "ascending", "first_falls", "last_below_share_of_first"),
            *("falls_and_settles", "own_is_smallest", "mean_of_longest_falls", "share_of_points_near"),
        )
    ),
]
"""Type of the name of a test in `opml.report.paper_claims`."""

Resonance = Annotated[tuple[Count, Count], Strict(False), Expected("a pair of whole numbers above 0")]

ResonanceList = Annotated[list[Resonance], Unique()]

Train = Annotated[
    str,
    Field(pattern=f"^(?:{naming.TRAIN})$"),
    Expected("random-<percent>, grouped-<percent> or days-<first>-<last>"),
]

Test = Annotated[
    str,
    Field(pattern=f"^(?:{naming.TEST})$"),
    Expected("seen, rest, days-<first>-<last> or days-<first>-<last>-unseen"),
]

Tests = Annotated[list[Test], MinLen(1), Unique(), Expected("a list of days-<first>-<last>")]

SplitPair = Annotated[tuple[Train, Test], Strict(False), Expected("a pair of a training and a test split")]

Splits = Annotated[dict[EntryName, SplitPair], MinLen(1)]

Ratio = Annotated[int, Ge(1), Le(99), Expected("a whole percentage from 1 to 99")]

Ratios = Annotated[list[Ratio], MinLen(1), Unique(), Expected("a list of percentages")]

RatioKey = Annotated[
    str, Field(pattern="^[1-9][0-9]?$"), Expected("a whole percentage from 1 to 99, in quotes")
]

PublishedByRatio = Annotated[dict[RatioKey, Positive], Expected("P_ML by ratio, the ratio in quotes")]

ValueKey = Annotated[str, Field(pattern=r"^-?[0-9]+(\.[0-9]+)?$"), Expected("a number in quotes")]

PublishedByValue = Annotated[
    dict[Test, Annotated[dict[ValueKey, Positive], Expected("P_ML by value, the value in quotes")]],
    Expected("P_ML by test and value, the value in quotes"),
]
