"""A pattern against a detector of torchvision, by a loss of one's own, as our printer prints it.

    pip install 'scaleproof[torch]' torchvision
    python attack_in_torch.py FRAMES pattern.png [STEPS]

The detector has random weights here, so that nothing is fetched: `weights="DEFAULT"` takes the trained ones. Against an overfitted pattern a run for
an experiment also varies scale, light and noise, and holds views out, as `scaleproof attack run` does.
"""

import sys

import torch
from torchvision.models.detection import ssdlite320_mobilenet_v3_large

import scaleproof
from scaleproof.torch import render

TILE_MM, CELLS, CAR = 480.0, 16, 3

frames = scaleproof.Frames(sys.argv[1])
views = [frames.view(index, cells=CELLS, tile_mm=TILE_MM) for index in range(len(frames))]
torch.manual_seed(0)
device = "cuda" if torch.cuda.is_available() else "cpu"
model = ssdlite320_mobilenet_v3_large(weights=None, weights_backbone=None).eval().to(device)
model.backbone.train()  # of random weights only: their signal is lost without the norms of the batch


def confidence(images):
    """The highest confidence that any box of each image is of a car, before boxes suppress each other."""
    batch, _ = model.transform(list(images))
    scores = model.head(list(model.backbone(batch.tensors).values()))["cls_logits"].softmax(-1)
    return scores[..., CAR].amax(1)


logits = torch.zeros(3, CELLS, CELLS, device=device, requires_grad=True)
optimiser = torch.optim.Adam([logits], lr=0.1)
for step in range(int(sys.argv[3]) if len(sys.argv) > 3 else 100):
    images = render(torch.sigmoid(logits), views)
    loss = confidence(images).mean()
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
    print(f"{step}: {loss.item():.8f}")
colours = torch.sigmoid(logits).detach().permute(1, 2, 0).cpu().numpy()
print(scaleproof.Pattern.save(sys.argv[2], colours, tile_mm=TILE_MM, made_by="attack_in_torch.py", detectors=["ssdlite320"]))
