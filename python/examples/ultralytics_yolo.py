"""Any detector of Ultralytics.

    pip install ultralytics ./python
    scaleproof score SESSION --detector 'exec:python3 python/examples/ultralytics_yolo.py yolo11n.pt' -o report
"""

import sys

import scaleproof_detector  # first: it keeps standard output for itself
import ultralytics

weights = sys.argv[1]
model = ultralytics.YOLO(weights)


def detect(image):
    # Ultralytics takes arrays with blue first.
    boxes = model.predict(image[..., ::-1], conf=0.001, max_det=100, verbose=False)[0].boxes
    return zip(boxes.cls.tolist(), boxes.conf.tolist(), boxes.xyxy.tolist())


scaleproof_detector.run(
    detect,
    name=weights.rsplit("/", 1)[-1].removesuffix(".pt"),
    version=f"ultralytics {ultralytics.__version__}, {weights}",
    labels=[model.names[i] for i in range(len(model.names))],
    files=[weights],
    licence="AGPL-3.0",
)
