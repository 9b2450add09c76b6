"""The native module in this process: where ONNX Runtime is, commands, progress."""

from __future__ import annotations

import importlib.util
import json
import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

SHARE = Path(__file__).parent / "share"


def _onnxruntime() -> Path | None:
    """The shared library that the package ``onnxruntime`` carries."""
    found = importlib.util.find_spec("onnxruntime")
    for folder in (found and found.submodule_search_locations) or ():
        for name in ("libonnxruntime.so*", "libonnxruntime*.dylib"):
            libraries = [path for path in sorted(Path(folder, "capi").glob(name)) if "providers" not in path.name]
            if libraries:
                return libraries[0]
    return None


_library = _onnxruntime()
if _library is not None and not os.environ.get("ORT_DYLIB_PATH"):
    os.environ["ORT_DYLIB_PATH"] = str(_library)
if SHARE.is_dir() and not os.environ.get("SCALEPROOF_HOME"):
    os.environ["SCALEPROOF_HOME"] = str(SHARE)

# ONNX Runtime's own builds would keep for Microsoft what they run on; this is read when the library is loaded.
os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")

from . import _native  # noqa: E402  (its library is looked for where the lines above say)

_native.begin(str(_native.__file__))

Error = _native.Error
__version__: str = _native.version

#: What a path may be given as.
PathLike = str | os.PathLike[str]


def shown(value: object) -> str:
    """A value in a message, cut where it is long."""
    text = repr(value)
    return text if len(text) <= 80 else text[:80] + "…"


def path(value: PathLike) -> str:
    """A path as text, or :class:`Error` for what is none."""
    try:
        text = os.fspath(value)
    except TypeError:
        text = None
    if not isinstance(text, str):
        raise Error(f"{shown(value)} is no path: give a str or a pathlib.Path")
    if "\0" in text:
        raise Error(f"{shown(value)} is no path: it has a byte 0")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise Error(f"{shown(value)} is not UTF-8 text: give another name") from None
    return text


def line(*words: str, paths: Sequence[str] = ()) -> list[str]:
    """A command's words and options, and behind ``--`` its paths: there, one that begins with a hyphen is no option."""
    return [*words, "--", *paths] if paths else list(words)


def run(*words: str, paths: Sequence[str] = ()) -> bytes:
    """What a command of the program prints."""
    printed, _ = _native.run(line("--quiet", *words, paths=paths))
    return printed


def answer(*words: str, paths: Sequence[str] = ()) -> dict[str, Any]:
    """What a command of the program prints with ``--json``."""
    found = json.loads(run(*words, "--json", paths=paths))
    assert isinstance(found, dict)
    return found


def options(**given: object) -> list[str]:
    """Options of the program: ``paper="a3"`` is ``--paper a3``, ``mirror=True`` is ``--mirror``, a list repeats its option, and None is left out."""
    words: list[str] = []
    for name, value in given.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        values: Sequence[object] = value if isinstance(value, (list, tuple)) else [value]
        for one in values:
            if one is True:
                words.append(option)
            elif one is not None and one is not False:
                # Joined, so that a value that begins with a hyphen is no option.
                words.append(f"{option}={os.fspath(one) if isinstance(one, os.PathLike) else one}")
    return words


def progress(shown: bool | None, what: str) -> tuple[Callable[[int, int], None] | None, Callable[[], None]]:
    """A bar of ``tqdm`` where that is installed: what to call with (done, of), and what to call at the end. None shows it for a terminal or a notebook."""
    if shown is False:
        return None, lambda: None
    try:
        with warnings.catch_warnings():
            # In a notebook without ipywidgets it warns that its bar is a plain one.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return None, lambda: None
    bar: Any = None

    def step(done: int, of: int) -> None:
        nonlocal bar
        if bar is None:
            bar = tqdm(total=of, desc=what, unit="photo", disable=None if shown is None else False, leave=False)
        bar.update(done - bar.n)

    return step, lambda: bar.close() if bar is not None else None
