"""Faster R-CNN of torchvision, to be scored and attacked.

    pip install torch torchvision ./python
    scaleproof score SESSION --detector 'exec:python3 python/examples/torchvision_frcnn.py' -o report
    scaleproof attack run FRAMES --detector 'exec:python3 python/examples/torchvision_frcnn.py' -o attacked
"""

import scaleproof_detector  # first: it keeps standard output for itself
import torch
import torchvision
from torchvision.models.detection import FasterRCNN_ResNet50_FPN_V2_Weights, fasterrcnn_resnet50_fpn_v2
from torchvision.ops import box_iou

device = "cuda" if torch.cuda.is_available() else "cpu"
weights = FasterRCNN_ResNet50_FPN_V2_Weights.COCO_V1
model = fasterrcnn_resnet50_fpn_v2(weights=weights, box_score_thresh=0.001).eval().requires_grad_(False).to(device)


@torch.inference_mode()
def detect(image):
    pixels = torch.from_numpy(image.copy()).permute(2, 0, 1).to(device) / 255
    found = model([pixels])[0]
    return zip(found["labels"].tolist(), found["scores"].tolist(), found["boxes"].tolist())


# The boxes that are left after suppression stand for all: the surest one is among them. Proposals are detached from the image.
def loss_and_gradient(image, box, labels, least_iou):
    pixels = torch.tensor(image, device=device, requires_grad=True)
    found = model([pixels.permute(2, 0, 1)])[0]
    meets = box_iou(found["boxes"], torch.tensor([box], device=device))[:, 0] >= least_iou
    meets &= torch.isin(found["labels"], torch.tensor(labels, device=device))
    if not meets.any():
        return None
    loss = -torch.log1p(-found["scores"][meets].max())
    loss.backward()
    return loss.item(), pixels.grad.cpu().numpy()


scaleproof_detector.run(
    detect,
    name="frcnn_v2",
    title="Faster R-CNN R50 FPN v2",
    version=f"torch {torch.__version__}, torchvision {torchvision.__version__}, {weights}, {device}",
    labels="coco91",
    licence="BSD-3-Clause",
    origin=weights.url,
    loss_and_gradient=loss_and_gradient,
    partial_gradient=True,
)
