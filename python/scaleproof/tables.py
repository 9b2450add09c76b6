"""Tables of results: columns, for pandas and pyarrow without needing either (the Arrow C data interface)."""

from __future__ import annotations

import csv
import ctypes
import html
import io
from collections.abc import Callable
from typing import Any

import numpy

Value = int | float | bool | str | None


class Table:
    """A table of named columns of one length; None stands where there is no value.

    ``pandas.DataFrame(table.columns)`` or :meth:`to_pandas` make a data frame; ``pyarrow.table(table)``, ``polars.DataFrame(table)`` and others read it
    through the Arrow C data interface (``__arrow_c_stream__``).
    """

    def __init__(self, columns: dict[str, list[Value]]) -> None:
        #: Values by column.
        self.columns = columns

    @staticmethod
    def _of_csv(text: str) -> Table:
        header, *lines = list(csv.reader(io.StringIO(text)))
        raw = {name: [line[at] for line in lines] for at, name in enumerate(header)}
        return Table({name: _typed(values) for name, values in raw.items()})

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), []))

    def __getitem__(self, column: str) -> list[Value]:
        return self.columns[column]

    def __repr__(self) -> str:
        return f"Table of {len(self)} rows: {', '.join(self.columns)}"

    def rows(self) -> list[dict[str, Value]]:
        """One dictionary a row."""
        return [dict(zip(self.columns, row)) for row in zip(*self.columns.values())]

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``; pandas must be installed."""
        import pandas

        return pandas.DataFrame(self.columns)

    def _repr_html_(self) -> str:
        def cells(tag: str, values: Any) -> str:
            shown = ("" if v is None else f"{v:.6g}" if isinstance(v, float) else str(v) for v in values)
            return "<tr>" + "".join(f"<{tag}>{html.escape(text)}</{tag}>" for text in shown) + "</tr>"

        rows = "".join(cells("td", row) for row in zip(*self.columns.values()))
        return f"<table>{cells('th', self.columns)}{rows}</table>"

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """A stream of one record batch; a requested schema is not followed, as the interface allows."""
        return _stream(self)


def _typed(values: list[str]) -> list[Value]:
    """Whole numbers, numbers or truths where all that is given reads as such; else text."""
    given = [value for value in values if value]
    if given and all(value in ("true", "false") for value in given):
        return [value == "true" if value else None for value in values]
    kinds: tuple[Callable[[str], Value], ...] = (int, float)
    for kind in kinds:
        try:
            return [kind(value) if value else None for value in values]
        except ValueError:
            pass
    return [value or None for value in values]


# --- the Arrow C data interface: https://arrow.apache.org/docs/format/CDataInterface.html and CStreamInterface.html -------------------------


class _Schema(ctypes.Structure):
    pass


class _Array(ctypes.Structure):
    pass


class _Stream(ctypes.Structure):
    pass


_p, _n = ctypes.c_void_p, ctypes.c_int64
_Release = ctypes.CFUNCTYPE(None, _p)
_Get = ctypes.CFUNCTYPE(ctypes.c_int, _p, _p)
_LastError = ctypes.CFUNCTYPE(_p, _p)
_Schema._fields_ = [
    ("format", ctypes.c_char_p),
    ("name", ctypes.c_char_p),
    ("metadata", _p),
    ("flags", _n),
    ("n_children", _n),
    ("children", _p),
    ("dictionary", _p),
    ("release", _Release),
    ("private_data", _p),
]
_Array._fields_ = [
    ("length", _n),
    ("null_count", _n),
    ("offset", _n),
    ("n_buffers", _n),
    ("n_children", _n),
    ("buffers", _p),
    ("children", _p),
    ("dictionary", _p),
    ("release", _Release),
    ("private_data", _p),
]
_Stream._fields_ = [
    ("get_schema", _Get),
    ("get_next", _Get),
    ("get_last_error", _LastError),
    ("release", _Release),
    ("private_data", _p),
]

#: What structures that were handed out point to, by their number, until they are released. Consumers may move a structure, so that its address is no name for it.
_kept: dict[int, tuple[object, ...]] = {}
_next = iter(range(1, 2**62))
_NULLABLE = 2


def _keep(*parts: object) -> int:
    number = next(_next)
    _kept[number] = parts
    return number


def _released(structure: type[ctypes.Structure]) -> Any:
    def release(address: int) -> None:
        one: Any = structure.from_address(address)
        # Those that a consumer has moved elsewhere have no release here any more.
        children = getattr(one, "children", None)
        for child in (_p * one.n_children).from_address(children) if children else ():
            inner: Any = structure.from_address(child or 0)
            if inner.release:
                inner.release(child)
        _kept.pop(one.private_data, None)
        one.release = _Release()

    return _Release(release)


_release_schema, _release_array, _release_stream = (_released(kind) for kind in (_Schema, _Array, _Stream))


def _pointers(parts: list[Any]) -> Any:
    return (_p * max(len(parts), 1))(*parts)


def _format(values: list[Value]) -> bytes:
    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return b"b"
    if kinds == {int}:
        return b"l"
    return b"g" if kinds and kinds <= {int, float} else b"u"


def _bits(values: Any) -> Any:
    return numpy.packbits(numpy.array(values, bool), bitorder="little")


def _fill_schema(schema: Any, format: bytes, name: bytes, children: list[Any]) -> None:
    pointers = _pointers([ctypes.addressof(child) for child in children])
    schema.format, schema.name, schema.metadata, schema.flags = format, name, None, _NULLABLE
    schema.n_children, schema.children, schema.dictionary = len(children), ctypes.cast(pointers, _p), None
    schema.release, schema.private_data = _release_schema, _keep(format, name, children, pointers)


def _fill_array(array: Any, length: int, nulls: int, buffers: list[Any], children: list[Any]) -> None:
    addresses = _pointers([None if buffer is None else buffer.ctypes.data for buffer in buffers])
    pointers = _pointers([ctypes.addressof(child) for child in children])
    array.length, array.null_count, array.offset = length, nulls, 0
    array.n_buffers, array.buffers = len(buffers), ctypes.cast(addresses, _p)
    array.n_children, array.children, array.dictionary = len(children), ctypes.cast(pointers, _p), None
    array.release, array.private_data = _release_array, _keep(buffers, addresses, children, pointers)


def _column(values: list[Value]) -> tuple[int, list[Any]]:
    """How many have no value, and the buffers."""
    there = [value is not None for value in values]
    format, nulls = _format(values), len(values) - sum(there)
    valid = _bits(there) if nulls else None
    if format == b"b":
        return nulls, [valid, _bits([value is True for value in values])]
    if format == b"u":
        texts = [b"" if value is None else str(value).encode() for value in values]
        offsets = numpy.cumsum([0, *map(len, texts)]).astype(numpy.int32)
        return nulls, [valid, offsets, numpy.frombuffer(b"".join(texts) or b"\0", numpy.uint8)]
    kind = numpy.int64 if format == b"l" else numpy.float64
    return nulls, [valid, numpy.array([0 if value is None else value for value in values], kind)]


def _stream(table: Table) -> object:
    left = [table]

    def get_schema(_: int, out: int) -> int:
        children = [_Schema() for _ in table.columns]
        for child, (name, values) in zip(children, table.columns.items()):
            _fill_schema(child, _format(values), name.encode(), [])
        _fill_schema(_Schema.from_address(out), b"+s", b"", children)
        return 0

    def get_next(_: int, out: int) -> int:
        if not left:
            _Array.from_address(out).release = _Release()
            return 0
        left.clear()
        children = [_Array() for _ in table.columns]
        for child, values in zip(children, table.columns.values()):
            _fill_array(child, len(values), *_column(values), [])
        _fill_array(_Array.from_address(out), len(table), 0, [None], children)
        return 0

    stream = _Stream(_Get(get_schema), _Get(get_next), _LastError(lambda _: None), _release_stream)
    number = _keep(stream, get_schema, get_next)
    stream.private_data = number
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, [_p, ctypes.c_char_p, _p]
    return new(ctypes.addressof(stream), b"arrow_array_stream", ctypes.cast(_drop_capsule, _p))


def _drop(capsule: int) -> None:
    get = ctypes.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = _p, [_p, ctypes.c_char_p]
    address = get(capsule, b"arrow_array_stream")
    if address and _Stream.from_address(address).release:
        _release_stream(address)


_drop_capsule = ctypes.PYFUNCTYPE(None, _p)(_drop)
