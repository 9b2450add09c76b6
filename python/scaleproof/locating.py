"""Scenes, cameras, and where photos were taken."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy
import numpy.typing

from . import _native
from ._process import Error, PathLike, path, progress as _progress

#: An upright image: height × width × 3 bytes, red first.
Image = numpy.typing.NDArray[numpy.uint8]
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Tag:
    """A tag of a scene."""

    family: str
    id: int
    #: Side of its black square.
    size_mm: float


class Scene:
    """What stands on the table: a file ``scene.toml`` with the model, its tags and the bins.

    Raises :class:`Error` for a file that cannot be read or is no scene.
    """

    def __init__(self, file: PathLike) -> None:
        self.file: str = path(file)
        self._native = _native.Scene(self.file)
        name, scale, size, labels, tags = self._native.about()
        #: The model's name.
        self.name: str = name
        #: The model is 1 : scale.
        self.scale: float = scale
        #: Length, width and height of the model.
        self.size_mm: tuple[float, ...] = tuple(size)
        #: Labels of detectors that count as the model.
        self.labels: tuple[str, ...] = tuple(labels)
        self.tags: tuple[Tag, ...] = tuple(Tag(*tag) for tag in tags)

    def __repr__(self) -> str:
        return f"Scene({self.file!r}): {self.name} at 1:{self.scale:g}, {len(self.tags)} tags"


class Camera:
    """A camera file: YAML or XML of OpenCV, of ROS or Kalibr, a ``.cameramodel`` of mrcal and others.

    Raises :class:`Error` for a file that cannot be read or is no camera.
    """

    def __init__(self, file: PathLike) -> None:
        self.file: str = path(file)
        self._native = _native.Camera(self.file)
        #: Width and height of its images, px.
        self.size: tuple[int, int] = self._native.size()

    @property
    def matrix(self) -> numpy.typing.NDArray[numpy.float64]:
        """The camera matrix, 3 × 3, px; pixel (0, 0) is the centre of the top-left pixel."""
        fx, fy, cx, cy = self._native.matrix()
        return numpy.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])

    def __repr__(self) -> str:
        return f"Camera({self.file!r}): {self.size[0]} × {self.size[1]} px"


@dataclass(frozen=True)
class Located:
    """Where a photo was taken, or why nobody knows. True where there is a pose."""

    #: The photo's path, or the name of an array.
    file: str
    #: ``T_camera_model``, 4 × 4, mm: maps points of the model frame to the camera frame. None without a pose.
    pose: numpy.typing.NDArray[numpy.float64] | None
    #: 0° looks at the front, counter-clockwise from above, in [0, 360).
    azimuth_deg: float | None
    #: Above the ground plane, in [-90, 90].
    pitch_deg: float | None
    #: From the camera to the model's target point, at model scale.
    distance_mm: float | None
    #: Standard deviations of the three.
    sigma_azimuth_deg: float | None
    sigma_pitch_deg: float | None
    sigma_distance_mm: float | None
    #: The scene's bin as (azimuth_deg, pitch_deg, distance_mm), and the probability that it is the right one.
    bin: tuple[float, float, float] | None
    bin_probability: float | None
    #: Why there is no pose, as a word for programs; ``unreadable`` for a photo that cannot be read.
    code: str | None
    #: The same as a sentence for the photographer.
    reason: str | None
    #: Words for what weakens the pose.
    warnings: tuple[str, ...]
    #: Ids of the tags that the pose rests on.
    tags: tuple[int, ...]
    #: Root mean square distance between seen and projected corners.
    rms_px: float | None
    #: Sentences on what to know before believing the pose.
    cautions: tuple[str, ...]
    #: All that ``scaleproof locate --json`` prints of the photo.
    json: dict[str, Any] = field(repr=False)

    def __bool__(self) -> bool:
        return self.pose is not None

    @staticmethod
    def _read(line: str) -> Located:
        found = json.loads(line)
        sigma, bin = found["sigma"] or {}, found["bin"]
        rows = found["T_camera_model"]
        return Located(
            file=found["file"],
            pose=None if rows is None else numpy.array(rows, numpy.float64),
            azimuth_deg=found["azimuth_deg"],
            pitch_deg=found["pitch_deg"],
            distance_mm=found["distance_mm"],
            sigma_azimuth_deg=sigma.get("azimuth_deg"),
            sigma_pitch_deg=sigma.get("pitch_deg"),
            sigma_distance_mm=sigma.get("distance_mm"),
            bin=bin and (bin["azimuth_deg"], bin["pitch_deg"], bin["distance_mm"]),
            bin_probability=found["bin_probability"],
            code=found["code"],
            reason=found["reason"],
            warnings=tuple(found["warnings"]),
            tags=tuple(found["tags"]),
            rms_px=found["rms_px"],
            cautions=tuple(found["cautions"]),
            json=found,
        )


def _given(photo: PathLike | Image, number: int) -> str | tuple[bytes, str, int, int]:
    """A photo as the native module takes it."""
    if not isinstance(photo, numpy.ndarray):
        return path(photo)
    if photo.ndim != 3 or photo.shape[2] != 3 or photo.dtype != numpy.uint8:
        raise Error(
            f"the image {number} has the shape {photo.shape} and the type {photo.dtype}: give height × width × 3 of uint8, red first, upright"
        )
    height, width, _ = photo.shape
    if not 0 < height * width <= 2**28:
        raise Error(f"the image {number} has {width} × {height} px: give one of 1 px or more, and of at most 268 megapixels")
    return photo.tobytes(), f"image {number}", width, height


def _threads(threads: int | None) -> int | None:
    if threads is not None and not 1 <= threads <= 1024:
        raise Error(f"threads is {threads}: give a number from 1 to 1024")
    return threads


def locate(photo: PathLike | Image, scene: Scene, camera: Camera, *, tag_detector: str = "cascade") -> Located:
    """Where a photo was taken: a file, or an upright image of height × width × 3 bytes, red first.

    A photo without a pose is no error: its answer is false, and has the reason. A photo that cannot be read raises :class:`Error`.
    """
    (found,) = locate_many([photo], scene, camera, tag_detector=tag_detector, threads=1, progress=False)
    if found.code == "unreadable":
        raise Error(found.reason)
    return found


def locate_many(
    photos: Iterable[PathLike | Image],
    scene: Scene,
    camera: Camera,
    *,
    tag_detector: str = "cascade",
    threads: int | None = None,
    progress: bool | None = None,
) -> list[Located]:
    """Where photos were taken, one answer each, in their order; ``threads`` at a time, one a core by default.

    A photo that cannot be read has the code ``unreadable``. Ctrl-C ends it.
    """
    if not isinstance(scene, Scene) or not isinstance(camera, Camera):
        raise Error("scene and camera are a scaleproof.Scene and a scaleproof.Camera: make them of their files")
    if isinstance(photos, (str, bytes)):
        raise Error("photos is one path: give a list of them, or use scaleproof.locate")
    given = [_given(photo, number) for number, photo in enumerate(photos, 1)]
    step, close = _progress(progress, "locating")
    try:
        lines = _native.locate(given, scene._native, camera._native, tag_detector, _threads(threads), step)
    finally:
        close()
    return [Located._read(line) for line in lines]


def truth_box(
    scene: Scene, pose: Sequence[Sequence[float]] | numpy.typing.NDArray[Any], camera: Camera, size: tuple[int, int] | None = None
) -> Box:
    """The box around what a photo holds of the model: left, top, right, bottom, px.

    ``pose`` is ``T_camera_model``, 4 × 4, mm, as :attr:`Located.pose`. ``size`` is the width and height of the photo, where that is not the camera's.
    Raises :class:`Error` where the model is not in the photo, or beyond what the lens model describes.
    """
    try:
        rows = numpy.asarray(pose, numpy.float64)
    except (TypeError, ValueError):
        raise Error("the pose is no array of numbers: give T_camera_model, 4 × 4, mm") from None
    turn = rows[:3, :3] if rows.shape == (4, 4) else numpy.zeros((3, 3))
    is_rotation = numpy.isfinite(rows).all() and numpy.allclose(turn @ turn.T, numpy.eye(3), atol=1e-6)
    if not is_rotation or numpy.linalg.det(turn) < 0 or not numpy.allclose(rows[3], [0, 0, 0, 1]):
        raise Error(f"the pose of shape {rows.shape} is no rigid motion: give T_camera_model, 4 × 4, mm, as Located.pose has it")
    width, height = camera.size if size is None else size
    if not (math.isfinite(width) and 0 < width < 2**20 and 0 < height < 2**20):
        raise Error(f"the photo's size is {width} × {height} px: give its width and height")
    return scene._native.truth_box(rows.tolist(), camera._native, (int(width), int(height)))
