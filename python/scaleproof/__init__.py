"""Physical validation of adversarial patterns on printed scale models, from Python.

Print a pattern at 1:10, photograph the model among AprilTags, and score object detectors per viewpoint. The program ``scaleproof`` comes with this
package; the functions here do the same work in the process, with the same results.

Lengths are millimetres and angles degrees. Boxes are left, top, right, bottom in pixels from the photo's corner. The model frame has x to the front,
y to the left and z up, with its origin on the ground below the model; the camera frame is OpenCV's. Whatever cannot be done raises :class:`Error`
with one sentence: what was wrong, where, and what to do.
"""

from ._process import Error, __version__
from .frames import Frames, View
from .locating import Camera, Located, Scene, Tag, locate, locate_many, truth_box
from .printing import Pattern, calibrate, print_template, print_wrap
from .scoring import Comparison, Detector, Drop, Figures, Found, Interval, Plan, Rate, Scores, Session, Summary, ap, compare, plan, score
from .tables import Table

__all__ = [
    "Camera",
    "Comparison",
    "Detector",
    "Drop",
    "Error",
    "Figures",
    "Found",
    "Frames",
    "Interval",
    "Located",
    "Pattern",
    "Plan",
    "Rate",
    "Scene",
    "Scores",
    "Session",
    "Summary",
    "Table",
    "Tag",
    "View",
    "__version__",
    "ap",
    "calibrate",
    "compare",
    "locate",
    "locate_many",
    "plan",
    "print_template",
    "print_wrap",
    "score",
    "truth_box",
]
