"""Faster R-CNN of torchvision.

    pip install torch torchvision ./python
    scaleproof score SESSION --detector 'exec:python3 python/examples/torchvision_frcnn.py' -o report
"""

import scaleproof_detector  # first: it keeps standard output for itself
import torch
import torchvision
from torchvision.models.detection import FasterRCNN_ResNet50_FPN_V2_Weights, fasterrcnn_resnet50_fpn_v2

device = "cuda" if torch.cuda.is_available() else "cpu"
weights = FasterRCNN_ResNet50_FPN_V2_Weights.COCO_V1
model = fasterrcnn_resnet50_fpn_v2(weights=weights, box_score_thresh=0.001).eval().to(device)


@torch.inference_mode()
def detect(image):
    pixels = torch.from_numpy(image.copy()).permute(2, 0, 1).to(device) / 255
    found = model([pixels])[0]
    return zip(found["labels"].tolist(), found["scores"].tolist(), found["boxes"].tolist())


scaleproof_detector.run(
    detect,
    name="frcnn_v2",
    title="Faster R-CNN R50 FPN v2",
    version=f"torch {torch.__version__}, torchvision {torchvision.__version__}, {weights}, {device}",
    labels="coco91",
    licence="BSD-3-Clause",
    origin=weights.url,
)
