"""Lines of CCSDS messages in XML as key-value notation has them, each with its line in the file.

Source: CCSDS 505.0-B-2 (XML specification for navigation data messages).
"""

import io
import xml.sax
from typing import Any
from xml.sax.handler import ContentHandler, LexicalHandler, property_lexical_handler

from opml.base.files import FilePath
from opml.interop.orbit_arcs import line_error

NumberedLine = tuple[int, str]  # number and text of a line

_MESSAGES = ("oem", "omm", "cdm", "tdm")
_BLOCKS = {("oem", "metadata"): "META", ("tdm", "metadata"): "META", ("tdm", "data"): "DATA"}
"""Elements of messages that stand between lines of START and STOP."""

_JOINED = (("oem", "stateVector"), ("oem", "covarianceMatrix"), ("tdm", "observation"))
"""Elements of messages whose values share lines."""

_ROWS = tuple(slice(k * (k + 1) // 2, (k + 1) * (k + 2) // 2) for k in range(6))
"""Values of the rows of a covariance's lower triangle."""


def lines(path: FilePath, text: str) -> list[NumberedLine]:
    """Return the numbered lines of a text, in XML or not. Raises InputError for broken XML."""
    if not text.lstrip().startswith("<"):
        return [*enumerate(text.splitlines(), start=1)]
    messages, parser = _Messages(), xml.sax.make_parser()
    parser.setContentHandler(messages)
    parser.setProperty(property_lexical_handler, messages)
    try:
        parser.parse(io.StringIO(text))
    except xml.sax.SAXParseException as reason:
        raise line_error(path, reason.getLineNumber() or 1, "messages in XML", reason.getMessage()) from None
    return messages.lines


class _Messages(ContentHandler, LexicalHandler):
    """Collector of lines: of each element without children, of blocks and of joined elements."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[NumberedLine] = []
        self._message, self._leaf, self._text, self._unit = "", "", "", ""
        self._joined: dict[str, str] | None = None

    def setDocumentLocator(self, locator: Any) -> None:
        """Keep what names the line."""
        self._place = locator

    def startDTD(self, *_: Any) -> None:
        """Refuse definitions: entities that stand for each other many times take for ever."""
        raise xml.sax.SAXParseException("a document type", None, self._place)

    def startElement(self, name: str, attrs: Any) -> None:
        """Begin a message, a block, a joined element or a value."""
        self._leaf, self._text, self._unit = name.split(":")[-1], "", attrs.get("units", "")
        if self._leaf in _MESSAGES:
            self._message = self._leaf
            self._add(f"CCSDS_{self._message.upper()}_VERS = {attrs.get('version', '2.0')}")
        elif block := _BLOCKS.get((self._message, self._leaf)):
            self._add(f"{block}_START")
        elif (self._message, self._leaf) in _JOINED:
            self._joined = {}

    def characters(self, content: str) -> None:
        """Take a part of a value."""
        self._text += content

    def endElement(self, name: str) -> None:
        """End a value, where no element began since its own beginning, or whatever else it is."""
        leaf, self._leaf, name = self._leaf, "", name.split(":")[-1]
        if block := _BLOCKS.get((self._message, name)):
            self._add(f"{block}_STOP")
        elif (self._message, name) in _JOINED:
            self._join(name, self._joined or {})
            self._joined = None
        elif name in _MESSAGES:
            self._message = ""
        elif self._message and leaf == name != "USER_DEFINED":
            self._end_value(name, " ".join(self._text.split()))

    def _end_value(self, name: str, value: str) -> None:
        if self._joined is not None:
            self._joined |= {} if name == "COMMENT" else {name: value}
        elif name == "COMMENT":
            self._add(f"COMMENT {value}")
        elif not name.endswith("_VERS"):  # the line that begins a message has it already
            self._add(f"{name} = {value} [{self._unit}]" if self._unit else f"{name} = {value}")

    def _join(self, name: str, values: dict[str, str]) -> None:
        """Add the lines of a state, of a covariance behind those before it, or of observations."""
        if name == "stateVector":
            self._add(" ".join(values.values()))
            return
        epoch = values.pop("EPOCH", "")
        if name == "observation":
            for key, value in values.items():
                self._add(f"{key} = {epoch} {value}")
            return
        if self.lines[-1][1] == "COVARIANCE_STOP":
            self.lines.pop()
        else:
            self._add("COVARIANCE_START")
        self._add(f"EPOCH = {epoch}")
        if "COV_REF_FRAME" in values:
            self._add(f"COV_REF_FRAME = {values.pop('COV_REF_FRAME')}")
        for row in _ROWS:
            self._add(" ".join([*values.values()][row]))
        self._add("COVARIANCE_STOP")

    def _add(self, line: str) -> None:
        self.lines.append((int(self._place.getLineNumber()), line))
