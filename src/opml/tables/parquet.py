"""Writer and readers of tables as Parquet files: whole files, checked against schema and digests."""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from opml.base.errors import InputError
from opml.base.files import FilePath, replacing
from opml.tables.columns import Column, Schema
from opml.tables.schemas import SCHEMAS

_ARROW = {"float64": pa.float64(), "int64": pa.int64(), "bool": pa.bool_(), "string": pa.string()}


def write_table(
    path: FilePath, frame: pd.DataFrame, schema: str | Schema, *, metadata: Mapping[str, Any]
) -> None:
    """Write a table as Parquet, whole or not at all: a temporary file takes the name when it is complete.

    frame: exactly the schema's columns, in any order, with optional ones or without
    schema: name of a schema, or a schema (of a model, whose columns vary)
    metadata: JSON values for the file, such as epoch, seed and settings digest

    Raises ValueError where the columns are not the schema's.
    """
    schema = _resolve(schema).among(frame.columns)
    if set(frame.columns) != set(schema.names) or len(frame.columns) != len(schema.names):
        odd = sorted(set(frame.columns) ^ set(schema.names))
        raise ValueError(f"table {schema.name}: columns missing or not in the schema: {odd}")
    arrays = [_array(frame[column.name], column.dtype) for column in schema.columns]
    arrow = pa.schema(
        pa.field(
            column.name,
            _ARROW[column.dtype],
            nullable=False,
            metadata={"unit": column.unit, "frame": column.frame, "meaning": column.meaning},
        )
        for column in schema.columns
    )
    values = {"table": schema.name, **metadata}
    texts = {key: json.dumps(value, sort_keys=True, allow_nan=False) for key, value in sorted(values.items())}
    table = pa.table(arrays, schema=arrow.with_metadata(texts))

    with replacing(path) as temporary:
        pq.write_table(table, temporary, compression="zstd", write_statistics=False)
        with open(temporary, "r+b") as file:
            start, footer = _footer(file)
            seal = _SEAL + _digest_to(file, start) + hashlib.sha256(footer).digest()
            file.seek(start)
            file.write(seal + footer)


def read_table(path: FilePath, schema: str | Schema) -> pd.DataFrame:
    """Read a table and check it against its schema.

    schema: name of a schema, or a schema (of a model, whose columns vary)

    Raises InputError where the file is missing or damaged, or a column is missing or of another type.
    """
    schema = _resolve(schema)
    with _checked(path, schema) as (file, schema):
        return file.read(columns=schema.names, use_threads=False).to_pandas()


def read_runs(path: FilePath, schema: str | Schema, key: str) -> Iterator[pd.DataFrame]:
    """Yield the rows of a table by runs of one value in the column `key`, and hold few of them at a time.

    Raises InputError as `read_table` does.
    """
    schema = _resolve(schema)
    with _checked(path, schema) as (file, schema):
        rest: list[pd.DataFrame] = []  # the run that the next batch may go on with
        for batch in file.iter_batches(_BATCH_ROWS, columns=schema.names, use_threads=False):
            rows = pd.concat([*rest, batch.to_pandas()], ignore_index=True)
            *whole, last = (run for _, run in rows.groupby((rows[key] != rows[key].shift()).cumsum()))
            yield from whole
            rest = [last]
        yield from rest


def read_tables(paths: Iterable[FilePath], schema: str | Schema) -> pd.DataFrame:
    """Read tables of one schema into one table, below each other. Raises InputError as `read_table` does."""
    return pd.concat([read_table(path, schema) for path in paths], ignore_index=True)


def read_metadata(path: FilePath) -> dict[str, Any]:
    """Read the metadata of a table that `write_table` wrote.

    Raises InputError where the file is missing or damaged.
    """
    with _described(path) as file:
        values = _metadata(file)
    return {key: value for key, value in values.items() if key != "table"}


def is_table(content: bytes) -> bool:
    """Return whether a file is Parquet, by how it begins."""
    return content.startswith(b"PAR1")


def read_kind(path: FilePath) -> str:
    """Read the name of a table's schema. Raises InputError as `read_metadata` does."""
    with _described(path) as file:
        return str(_metadata(file)["table"])


def read_measured(path: FilePath) -> pd.DataFrame:
    """Read a table of what was measured: `tracking`, or another in its place. Raises as `read_table` does."""
    kind = read_kind(path)
    return read_table(path, kind if kind in ("fixes", "laser_ranges") else "tracking")


def read_schema(path: FilePath) -> Schema:
    """Read the schema that a table's file keeps itself, whatever its kind; what a row is, stays empty.

    Raises InputError as `read_metadata` does.
    """
    with _described(path) as file:
        name, arrow = str(_metadata(file)["table"]), file.schema_arrow
        dtypes = {arrow_type: dtype for dtype, arrow_type in _ARROW.items()}
        texts = [_texts(field.metadata) for field in arrow]
        return Schema(
            name,
            "",
            tuple(
                Column(field.name, dtypes[field.type], text["unit"], text["frame"], text["meaning"])
                for field, text in zip(arrow, texts, strict=True)
            ),
        )


def _resolve(schema: str | Schema) -> Schema:
    return SCHEMAS[schema] if isinstance(schema, str) else schema


def _array(values: pd.Series, dtype: str) -> pa.Array:
    if dtype == "string":
        return pa.array([str(value) for value in values], type=pa.string())
    # A numpy array keeps NaN a number; pandas' own conversion would make it a missing value.
    return pa.array(np.asarray(values).astype(dtype, casting="same_kind"), type=_ARROW[dtype])


def _texts(metadata: Mapping[bytes, bytes] | None) -> dict[str, str]:
    # Arrow adds PARQUET:field_id on reading.
    items = (metadata or {}).items()
    return {key.decode(): value.decode() for key, value in items if not key.startswith(b"PARQUET:")}


_BATCH_ROWS = 65536  # rows that are read at once where a table is read by parts

_SEAL = b"opmlseal"
"""Letters before the digests of a file's bytes, which stand between its pages and its footer.

Parquet's own checksums leave out the headers of pages and the footer. Readers locate the footer from the end
of the file, and pages from its beginning; both stay in place.
"""

_DIGEST_BYTES = hashlib.sha256().digest_size

_TAIL_BYTES = 8  # of a Parquet file: the length of its footer and four letters

_CHUNK_BYTES = 1 << 20

_ALIEN = "damaged, or not written by opml (it has no seal)"
_OTHER_VERSION = "another version of opml wrote it, use a new folder of results"


def _check_footer(path: FilePath) -> bytes | None:
    """Return the digest of a file's pages, None without a seal; raise InputError for another footer."""
    with open(path, "rb") as file:
        start, footer = _footer(file)
        file.seek(max(_end_of_pages(start), 0))
        letters, of_pages, of_footer = (
            file.read(size) for size in (len(_SEAL), _DIGEST_BYTES, _DIGEST_BYTES)
        )
    if letters != _SEAL:
        return None
    if of_footer != hashlib.sha256(footer).digest():
        raise InputError(f"{path}: damaged (its footer does not match its seal)")
    return of_pages


def _check_pages(path: FilePath, digest: bytes) -> None:
    with open(path, "rb") as file:
        start, _ = _footer(file)
        if _digest_to(file, _end_of_pages(start)) != digest:
            raise InputError(f"{path}: damaged (its pages do not match its seal)")


def _end_of_pages(footer: int) -> int:
    return footer - len(_SEAL) - 2 * _DIGEST_BYTES


def _digest_to(file: BinaryIO, end: int) -> bytes:
    digest = hashlib.sha256()
    file.seek(0)
    while chunk := file.read(min(_CHUNK_BYTES, end - file.tell())):
        digest.update(chunk)
    return digest.digest()


def _footer(file: BinaryIO) -> tuple[int, bytes]:
    """Return the start of a Parquet file's footer, by the length at the end, and the bytes from there on."""
    end = file.seek(0, os.SEEK_END)
    file.seek(max(end - _TAIL_BYTES, 0))
    length = int.from_bytes(file.read(4), "little")
    start = max(end - _TAIL_BYTES - length, 0)
    file.seek(start)
    return start, file.read()


@contextmanager
def _checked(path: FilePath, schema: Schema) -> Iterator[tuple[pq.ParquetFile, Schema]]:
    """Open a table, with the schema of its columns, and check these and every byte."""
    with _reading(path):
        if digest := _check_footer(path):
            _check_pages(path, digest)
        with pq.ParquetFile(path) as file:
            stored = file.schema_arrow  # made at each access
            schema = schema.among(stored.names)
            dtypes = dict(zip(stored.names, stored.types, strict=True))
            for column in schema.columns:
                if (dtype := dtypes.get(column.name)) is None:
                    missing = f"{path}: {column.name}: column of table {schema.name} is missing"
                    raise InputError(f"{missing}: {_OTHER_VERSION}")
                if dtype != _ARROW[column.dtype]:
                    raise InputError(f"{path}: {column.name}: expected {column.dtype}, got {dtype}")
            if not digest:
                raise InputError(f"{path}: {_ALIEN}")
            yield file, schema


@contextmanager
def _described(path: FilePath) -> Iterator[pq.ParquetFile]:
    """Open a table of which only the footer is read, and check that."""
    with _reading(path):
        if not _check_footer(path):
            raise InputError(f"{path}: {_ALIEN}")
        with pq.ParquetFile(path) as file:
            yield file


@contextmanager
def _reading(path: FilePath) -> Iterator[None]:
    """Turn the errors of a missing or damaged file into an InputError of one line."""
    try:
        yield
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (pa.ArrowException, OSError, ValueError, KeyError) as error:
        raise InputError(f"{path}: damaged, or not a table in Parquet ({error})") from None


def _metadata(file: pq.ParquetFile) -> dict[str, Any]:
    return {key: json.loads(value) for key, value in _texts(file.schema_arrow.metadata).items()}
