"""Scoring runs, comparisons and plans."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy

from . import _native
from ._process import Error, PathLike, answer, line, options, path, progress as _progress, shown
from .locating import Box, Image, _threads
from .tables import Table, Value

#: A box that a detector found: its label (a name, or a number from 0), confidence from 0 to 1, and left, top, right, bottom in px of the image.
Found = tuple[str | int, float, Sequence[float]]


@dataclass(frozen=True)
class Detector:
    """A function that finds objects, as a detector of :func:`score`.

    ``function(images)`` gets a list of upright images, height × width × 3 bytes each, red first, and returns for each a list of (label, confidence,
    (left, top, right, bottom)) in pixels of that image, or yields them. Give all boxes from confidence 0.001 up. It is called in the thread that calls
    :func:`score`, with as many images as are waiting and at most ``batch``. What it raises ends the run: the exception is the ``__cause__`` of the
    :class:`Error`.
    """

    function: Callable[[list[Image]], Iterable[Iterable[Found]]]
    #: Letters, digits, ``_``, ``-`` and ``.``.
    name: str
    #: ``coco80``, ``coco91`` (numbers are COCO's category ids), ``voc20``, or names in the order of their numbers.
    labels: str | Sequence[str] = "coco80"
    #: What reports call it; its name by default.
    title: str = ""
    #: A line for the report: versions, weights, settings.
    version: str = ""
    #: What its labels count as, where not as themselves.
    class_map: Mapping[str, str] | None = None
    #: Files that its answers depend on, such as weights: the report states their SHA-256.
    files: Sequence[PathLike] = ()
    #: Whether the same photo always gets the same answer; if not, the report says so.
    deterministic: bool = False
    batch: int = 4


class _Function:
    """A detector as the native module takes it."""

    def __init__(self, detector: Detector) -> None:
        if not callable(detector.function) or not isinstance(detector.name, str):
            raise Error(f"{detector!r} is no detector: give its function and its name")
        if not isinstance(detector.batch, int) or not 1 <= detector.batch <= 1024:
            raise Error(f"the batch of {detector.name} is {detector.batch!r}: give a number from 1 to 1024")
        self._function, self.name = detector.function, detector.name
        self.title, self.version = detector.title or detector.name, detector.version
        labels = detector.labels
        self.labels = json.dumps(labels if isinstance(labels, str) else [str(label) for label in labels])
        self.class_map = dict(detector.class_map or {})
        files = detector.files
        self.files = [_hashed(file) for file in ([files] if isinstance(files, (str, os.PathLike)) else files)]
        self.is_deterministic, self.batch = bool(detector.deterministic), detector.batch

    def call(self, photos: list[tuple[Any, str]]) -> list[list[tuple[str | int, float, list[float]]]]:
        images = [numpy.asarray(pixels) for pixels, _ in photos]
        answers = self._function(images)
        if answers is None or isinstance(answers, (dict, str)):
            raise Error(f"{self.name} returned {type(answers).__name__}: return a list of boxes for each image, [] for none")
        answers = list(answers)
        if len(answers) != len(photos):
            raise Error(f"{self.name} returned {len(answers)} lists of boxes for {len(photos)} images: return one for each")
        return [[self._plain(found, file) for found in self._boxes(boxes, file)] for boxes, (_, file) in zip(answers, photos)]

    def _boxes(self, boxes: Any, file: str) -> Any:
        if boxes is None or isinstance(boxes, (dict, str)):
            raise Error(f"{self.name} returned {type(boxes).__name__} for {file}: {_FORM}, and [] for none")
        return boxes

    def _plain(self, found: Any, file: str) -> tuple[str | int, float, list[float]]:
        """Numbers of any library as Python's own."""
        try:
            label, confidence, box = found
            if isinstance(confidence, str) or isinstance(box, (str, bytes, Mapping, Set)):
                raise TypeError
            label = str(label) if isinstance(label, str) else int(label)
            numbers = [float(confidence), *(float(number) for number in box)]
        except (TypeError, ValueError):
            raise Error(f"{self.name} gives {str(found)[:80]!r} for a box of {file}: {_FORM}") from None
        if len(numbers) != 5 or not all(map(math.isfinite, numbers)) or (isinstance(label, int) and label < 0):
            raise Error(
                f"{self.name} gives the label {label!r}, the confidence {numbers[0]} and the box {numbers[1:]} for {file}: "
                "a label is a name or a number from 0, a box four finite numbers"
            )
        return label, numbers[0], numbers[1:]


_FORM = "give (label, confidence, (left, top, right, bottom)) for each box"


def _hashed(file: PathLike) -> tuple[str, str]:
    there, hashed = Path(path(file)), hashlib.sha256()
    if there.exists() and not there.is_file():
        raise Error(f"{shown(os.fspath(file))} is not a file: name the files that the detector's answers depend on")
    try:
        with there.open("rb") as content:
            while part := content.read(1 << 20):
                hashed.update(part)
    except OSError as error:
        raise Error(f"{shown(os.fspath(file))} cannot be read: {error.strerror}") from None
    return there.name, hashed.hexdigest()


class Session:
    """A set of photos: a folder with a ``session.json``, or folders of photos of one texture each (:meth:`of_folders`), which stay as they are."""

    def __init__(self, folder: PathLike) -> None:
        self._paths, self._options = [path(folder)], list[str]()
        #: What ``scaleproof session show --json`` says of it; opening checks all but the photos.
        self.about: dict[str, Any] = answer("session", "show", paths=self._paths)

    @classmethod
    def of_folders(
        cls, folders: Mapping[str, PathLike], *, scene: PathLike, camera: PathLike, place: str | None = None
    ) -> Session:
        """Photos by the texture they show, as ``{"normal": "monday", "random@yard": "tuesday"}``; behind an @ stands the place, else ``place`` holds.

        Nothing is written. What is wrong with a folder is said when it is scored.
        """
        if not folders:
            raise Error("no folder is named: give the folder of each texture's photos")
        made = cls.__new__(cls)
        made._paths = [f"{texture}={path(folder)}" for texture, folder in folders.items()]
        made._options = options(scene=path(scene), camera=path(camera), place=place)
        made.about = {}
        return made

    def __repr__(self) -> str:
        return f"Session({self._paths[0]!r}): {self.about.get('photos', '?')} photos"


@dataclass(frozen=True)
class Rate:
    """A share of photos with Wilson's 95 % interval, 0 to 1."""

    count: int
    rate: float
    low: float
    high: float


@dataclass(frozen=True)
class Figures:
    """What a detector makes of some photos."""

    photos: int
    #: Average precision at IoU 0.5, and the mean of 0.5 to 0.95, by the definition that :attr:`Scores.ap_definition` names.
    ap50: float
    ap50_95: float
    #: Recall reached, likewise.
    mar50: float
    mar: float
    hit_rate: Rate
    misclassification_rate: Rate
    disappearance_rate: Rate
    hallucinations_per_image: float
    false_positives_per_image: float
    mean_confidence: float
    median_confidence: float

    @staticmethod
    def _read(found: dict[str, Any]) -> Figures:
        figures: dict[str, Any] = {name: Rate(**value) if isinstance(value, dict) else value for name, value in found.items()}
        return Figures(**figures)


@dataclass(frozen=True)
class Summary:
    """Figures of a detector on photos of one texture."""

    detector: str
    variant: str
    overall: Figures
    #: Differences from the base; None of the base itself.
    drop: dict[str, float] | None
    #: All that ``summary.json`` has of it: figures by direction, place and condition.
    json: dict[str, Any]


class _Report:
    """What runs and comparisons have in common."""

    _native: Any
    _columns: str

    def __init__(self, native: Any) -> None:
        self._native = native
        #: All of it, as the program writes it as JSON.
        self.json: dict[str, Any] = json.loads(native.json())
        #: What weakens the figures, as sentences.
        self.cautions: tuple[str, ...] = tuple(self.json["cautions"])
        #: Photos that are in no figure, and why.
        self.not_scored: tuple[dict[str, Any], ...] = tuple(self.json["not_scored"])

    def __str__(self) -> str:
        return str(self._native.table())

    def to_html(self) -> str:
        """The page of the report."""
        return str(self._native.html())

    def to_latex(self) -> str:
        """The table for a paper."""
        return str(self._native.latex())

    def write(self, folder: PathLike) -> str:
        """Writes all files that the program writes, together or not at all: the path of the page to open."""
        return str(self._native.write(path(folder)))

    @property
    def table(self) -> Table:
        """The figures, a row each."""
        return Table._of_csv(getattr(self._native, self._columns)())

    def to_pandas(self) -> Any:
        """:attr:`table` as a ``pandas.DataFrame``."""
        return self.table.to_pandas()

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self.table.__arrow_c_stream__(requested_schema)


class Scores(_Report):
    """What a scoring run found."""

    _columns = "figures_csv"

    def __init__(self, native: _native.Scores) -> None:
        super().__init__(native)
        #: One for each detector and texture, the base first.
        self.summaries: tuple[Summary, ...] = tuple(
            Summary(one["detector"], one["variant"], Figures._read(one["overall"]), one["drop"], one) for one in self.json["results"]
        )
        self.photos_scored: int = self.json["photos_scored"]
        self.ap_definition: str = self.json["ap_definition"]
        #: The texture that drops are measured from.
        self.base: str = self.json["base"]

    def __repr__(self) -> str:
        return f"Scores of {self.photos_scored} photos: {len(self.summaries)} figures of detectors and textures"

    def summary(self, detector: str, variant: str) -> Summary:
        """The figures of a detector on a texture."""
        for one in self.summaries:
            if (one.detector, one.variant) == (detector, variant):
                return one
        known = ", ".join(f"{one.detector} on {one.variant}" for one in self.summaries)
        raise Error(f"there are no figures of {detector} on {variant}, but of {known}")

    @property
    def photos(self) -> Table:
        """One row for each photo and detector."""
        return Table._of_csv(self._native.photos_csv())

    def compare(self) -> Comparison:
        """The textures against the base, on photos paired by place and bin."""
        return Comparison(self._native.compare())

    def _repr_html_(self) -> str:
        rows: list[dict[str, Value]] = [
            {
                "detector": one.detector,
                "texture": one.variant,
                "photos": one.overall.photos,
                "AP@0.5": one.overall.ap50,
                "hit rate": one.overall.hit_rate.rate,
                "mean confidence": one.overall.mean_confidence,
            }
            for one in self.summaries
        ]
        return Table({name: [row[name] for row in rows] for name in rows[0]})._repr_html_()


@dataclass(frozen=True)
class Interval:
    """A 95 % interval."""

    low: float
    high: float


@dataclass(frozen=True)
class Drop:
    """A detector's figures on a texture against those on the base."""

    detector: str
    variant: str
    pairs: int
    #: Of the mean confidence, the primary endpoint: both figures, and the drop with its interval.
    base: float
    other: float
    drop: float
    interval_95: Interval | None
    #: ``hides``, ``weakens``, ``strengthens``, ``nothing_shown`` or ``base_unseen``.
    effect: str
    #: Of the mean confidence, corrected over the detectors; an effect is shown where it is no larger than ``level``.
    p: float
    level: float
    #: All that ``comparison.json`` has of it: hit rate, AP and directions too.
    json: dict[str, Any]


class Comparison(_Report):
    """Textures against the base on paired photos."""

    _columns = "csv"

    def __init__(self, native: _native.Comparison) -> None:
        super().__init__(native)
        self.base: str = self.json["base"]
        self.drops: tuple[Drop, ...] = tuple(map(self._drop, self.json["results"]))

    @staticmethod
    def _drop(one: dict[str, Any]) -> Drop:
        confidence, finding = one["mean_confidence"], one["finding"]
        interval = confidence["interval_95"] and Interval(**confidence["interval_95"])
        figures = (confidence["base"], confidence["other"], confidence["drop"], interval)
        found = (finding["effect"], finding["confidence_p"], finding["confidence_level"])
        return Drop(one["detector"], one["variant"], one["pairs"], *figures, *found, one)

    def __repr__(self) -> str:
        return f"Comparison with {self.base}: {len(self.drops)} drops"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def score(
    session: Session | PathLike | Sequence[Session | PathLike],
    detectors: str | Detector | Callable[..., Any] | Sequence[str | Detector | Callable[..., Any]] | None = None,
    *,
    recorded: bool = False,
    ap: str | None = None,
    confidence: float | None = None,
    protocol: str | None = None,
    base: str | None = None,
    control: str | None = None,
    group_by: str | Sequence[str] = (),
    weights: PathLike | None = None,
    threads: int | None = None,
    cache: PathLike | None = None,
    progress: bool | None = None,
) -> Scores:
    """How well detectors see the model in photos: the figures of ``scaleproof score``, to the digits.

    A detector is a name or a manifest of the program, ``exec:PROGRAM``, a :class:`Detector`, or just its function ``images -> [(label, confidence, box)
    for each image]`` with COCO's 80 labels, by its own name. Without any, all whose weights are at hand take part; with ``recorded`` the detections
    that the sessions store. ``weights`` is a folder to look in. ``ap`` is ``coco-101``, ``all-point``, ``voc-11`` or ``yolov5-ramp``; ``confidence``
    counts as a hit; ``protocol``, ``base``, ``control`` and ``group_by`` are as the program's options.

    ``threads`` photos are looked at side by side: by default one a core, or as many as a detector's batch. ``cache`` is a folder that keeps what networks
    and programs found; functions are always asked. Ctrl-C ends the run.
    """
    given = [session] if isinstance(session, (Session, str, os.PathLike)) else list(session)
    paths = [word for one in given for word in (one._paths if isinstance(one, Session) else [path(one)])]
    words = [word for one in given if isinstance(one, Session) for word in one._options]
    several = isinstance(detectors, (list, tuple)) or (isinstance(detectors, Iterable) and not isinstance(detectors, str) and not callable(detectors))
    asked: list[Any] = [] if detectors is None else list(detectors) if several else [detectors]  # type: ignore[arg-type]
    if several and not asked:
        raise Error("no detector is named: name one, or leave `detectors` out for all whose weights are at hand")
    functions = [_Function(_detector(one)) for one in asked if not isinstance(one, (str, os.PathLike))]
    if threads is None and functions:
        threads = max([os.cpu_count() or 1, *(function.batch for function in functions)])
    words += options(
        detector=[os.fspath(one) for one in asked if isinstance(one, (str, os.PathLike))],
        detectors=weights,
        recorded=recorded,
        ap=ap,
        confidence=confidence,
        protocol=protocol,
        base=base,
        control=control,
        group_by=([group_by] if isinstance(group_by, str) else list(group_by)) or None,
        threads=_threads(threads),
        cache=cache,
    )
    step, close = _progress(progress, "scoring")
    try:
        return Scores(_native.score(line(*words, paths=paths), functions, step))
    finally:
        close()


def _detector(one: Any) -> Detector:
    if isinstance(one, Detector):
        return one
    if callable(one):
        name = getattr(one, "__name__", type(one).__name__)
        return Detector(one, "function" if name == "<lambda>" else name)
    raise Error(f"{shown(one)} is no detector: give a name, a manifest's path, a scaleproof.Detector or a function")


def compare(
    session: Session | PathLike | Sequence[Session | PathLike] | Scores, detectors: Any = None, **criteria: Any
) -> Comparison:
    """Is a texture harder to detect than the base, and can these photos tell? Of a run, or of photos as :func:`score` takes them."""
    scores = session if isinstance(session, Scores) else score(session, detectors, **criteria)
    return scores.compare()


@dataclass(frozen=True)
class Plan:
    """How many photos show a drop of the mean confidence."""

    drop: float
    power: float
    #: Decided together, with the textures.
    detectors: int
    #: Besides the base.
    textures: int
    #: Directions, each seen from one place, that show the drop.
    views: int
    #: Places, photographed all round, that have so many views.
    places: int
    #: Of all textures and the base, from every view of these places.
    photos: int
    #: All that ``scaleproof plan --json`` says.
    json: dict[str, Any] = field(repr=False)


def plan(
    drop: float = 0.2, session: Session | PathLike | None = None, *, power: float = 0.8, comparisons: tuple[int, int] | None = None
) -> Plan:
    """How many photos show such a drop of the mean confidence (0 to 1) of one detector with a power.

    ``comparisons`` are the numbers of detectors and of textures besides the base that are decided together: those of the session, else (5, 1). A session
    whose detections are stored tells how confidences vary from view to view. By simulated experiments, decided as :func:`compare` does.
    """
    among = None if comparisons is None else "x".join(str(number) for number in comparisons)
    where = None if session is None else session if isinstance(session, Session) else Session(session)
    words = options(drop=drop, power=power, comparisons=among)
    found = answer("plan", *words, *(where._options if where else []), paths=where._paths if where else [])
    names = "drop power detectors textures views places photos".split()
    drop, power, detectors, textures, views, places, photos = (found[name] for name in names)
    return Plan(drop, power, detectors, textures, views, places, photos, found)


def ap(
    truths: Sequence[Sequence[Box]],
    detections: Sequence[Sequence[tuple[float, Box]]],
    *,
    definition: str = "coco-101",
    iou: float | None = 0.5,
    crowds: Sequence[Sequence[Box]] | None = None,
) -> float | None:
    """Average precision of boxes of one class, by image: truths, and (confidence, box) in the detector's order.

    ``definition`` is ``coco-101``, ``all-point``, ``voc-11`` or ``yolov5-ramp``; ``iou`` None is the mean over COCO's 0.5 to 0.95. None without any truth.
    A detection in a crowd region counts neither for nor against.
    """
    regions = [[]] * len(truths) if crowds is None else crowds
    if not len(truths) == len(detections) == len(regions):
        raise Error(f"there are truths of {len(truths)} images and detections of {len(detections)}: give one list for each image")
    if iou is not None and not 0 < iou <= 1:
        raise Error(f"the IoU is {iou}: give a number above 0, at most 1")
    images = [
        (
            [_box(box, at) for box in of_truths],
            [_box(box, at) for box in of_crowds],
            [(_confidence(confidence, at), _box(box, at)) for confidence, box in found],
        )
        for at, (of_truths, of_crowds, found) in enumerate(zip(truths, regions, detections))
    ]
    found = _native.ap(images, definition, iou)
    return None if found is None else found[0]


def _confidence(confidence: Any, image: int) -> float:
    try:
        number = float(confidence)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise Error(f"{shown(confidence)} of image {image} is no confidence: give a finite number")
    return number


def _box(box: Any, image: int) -> list[float]:
    try:
        numbers = [] if isinstance(box, (str, bytes, Mapping, Set)) else [float(number) for number in box]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != 4 or not all(map(math.isfinite, numbers)) or numbers[0] > numbers[2] or numbers[1] > numbers[3]:
        raise Error(f"{shown(box)} of image {image} is no box: give four finite numbers, left, top, right, bottom, px")
    return numbers
