"""Any detector of Hugging Face's transformers.

    pip install torch transformers pillow ./python
    scaleproof score SESSION --detector 'exec:python3 python/examples/transformers_detr.py PekingU/rtdetr_v2_r18vd' -o report
"""

import sys

import scaleproof_detector  # first: it keeps standard output for itself
import torch
import transformers
from transformers import AutoImageProcessor, AutoModelForObjectDetection

checkpoint = sys.argv[1]
processor = AutoImageProcessor.from_pretrained(checkpoint)
model = AutoModelForObjectDetection.from_pretrained(checkpoint).eval()
names = model.config.id2label


@torch.inference_mode()
def detect(image):
    outputs = model(**processor(images=image, return_tensors="pt"))
    size = torch.tensor([image.shape[:2]])
    found = processor.post_process_object_detection(outputs, threshold=0.001, target_sizes=size)[0]
    for label, score, box in zip(found["labels"].tolist(), found["scores"].tolist(), found["boxes"].tolist()):
        yield names[label], score, box


scaleproof_detector.run(
    detect,
    name=checkpoint.rsplit("/", 1)[-1],
    version=f"torch {torch.__version__}, transformers {transformers.__version__}, {checkpoint}",
    labels=list(dict.fromkeys(names[i] for i in sorted(names))),
    origin=checkpoint,
)
