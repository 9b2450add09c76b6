"""YOLOX in JAX from its ONNX file: boxes, and the gradient that an attack needs, on whatever device JAX finds.

    pip install jax onnx ./python
    scaleproof attack run FRAMES --detector 'exec:python3 python/examples/jax_yolox.py yolox_nano.onnx' -o attacked
"""

import sys

import scaleproof_detector  # first: it keeps standard output for itself
import jax
import jax.numpy as jnp
import numpy as np
import onnx
from onnx import helper, numpy_helper

SIZE, NMS_IOU, FLOOR = 416, 0.45, 0.001
graph = onnx.load(sys.argv[1]).graph
weights = {tensor.name: numpy_helper.to_array(tensor) for tensor in graph.initializer}
grids = [(SIZE // stride, stride) for stride in (8, 16, 32)]
cells = np.concatenate([np.stack(np.meshgrid(range(n), range(n)), -1).reshape(-1, 2) for n, _ in grids])
strides = np.concatenate([np.full((n * n, 1), stride) for n, stride in grids])


def convolution(x, kernel, bias, *, pads, strides, group, dilations, **_):
    around = [(pads[0], pads[2]), (pads[1], pads[3])]
    y = jax.lax.conv_general_dilated(x, kernel, strides, around, rhs_dilation=dilations, feature_group_count=group)
    return y + bias.reshape(1, -1, 1, 1)


def maximum(x, *, kernel_shape, pads, strides, **_):
    around = [(0, 0), (0, 0), (pads[0], pads[2]), (pads[1], pads[3])]
    return jax.lax.reduce_window(x, -jnp.inf, jax.lax.max, (1, 1, *kernel_shape), (1, 1, *strides), around)


def sliced(x, starts, ends, axes, steps, **_):
    chosen = [slice(None)] * x.ndim
    for start, end, axis, step in zip(starts, ends, axes, steps):
        chosen[axis] = slice(int(start), int(min(end, x.shape[axis])), int(step))
    return x[tuple(chosen)]


def repeated(x, _roi, scales, **_):
    return x.repeat(int(scales[2]), 2).repeat(int(scales[3]), 3)


OPERATORS = {
    "Conv": convolution,
    "MaxPool": maximum,
    "Slice": sliced,
    "Resize": repeated,
    "Sigmoid": jax.nn.sigmoid,
    "Mul": jnp.multiply,
    "Add": jnp.add,
    "Concat": lambda *parts, axis: jnp.concatenate(parts, axis),
    "Reshape": lambda x, shape: x.reshape([int(side) for side in shape]),
    "Transpose": lambda x, perm: x.transpose(perm),
}


def network(image):
    """The file's output for an input of 1 × 3 × 416 × 416."""
    values = {"": None, graph.input[0].name: image, **weights}
    for node in graph.node:
        settings = {a.name: helper.get_attribute_value(a) for a in node.attribute}
        values[node.output[0]] = OPERATORS[node.op_type](*(values[name] for name in node.input), **settings)
    return values[graph.output[0].name][0]


def linear(count, size):
    """Weights of bilinear resizing along one axis, as OpenCV's INTER_LINEAR."""
    place = np.clip((np.arange(size) + 0.5) * count / size - 0.5, 0, count - 1)
    return np.maximum(0, 1 - np.abs(place[:, None] - np.arange(count))).astype(np.float32)


@jax.jit
def rows_of(image):
    """Boxes in pixels of the image, logarithms of objectness and of the labels' probabilities; the image is 0 to 1."""
    height, width, _ = image.shape
    ratio = min(SIZE / width, SIZE / height)
    size = [int(height * ratio), int(width * ratio)]
    resized = 255 * jnp.einsum("yh,xw,hwc->yxc", linear(height, size[0]), linear(width, size[1]), image, precision="highest")
    padded = jnp.full((SIZE, SIZE, 3), 114.0).at[: size[0], : size[1]].set(resized)
    rows = network(padded[..., ::-1].transpose(2, 0, 1)[None])
    centre = (rows[:, :2] + cells) * strides
    half = jnp.exp(rows[:, 2:4]) * strides / 2
    boxes = jnp.concatenate([centre - half, centre + half], 1) / ratio
    return jnp.clip(boxes, 0, jnp.array([width, height] * 2)), rows[:, 4], rows[:, 5:]


def iou(boxes, box):
    sides = jnp.maximum(0, jnp.minimum(boxes[:, 2:], box[2:]) - jnp.maximum(boxes[:, :2], box[:2]))
    area = lambda b: (b[..., 2] - b[..., 0]) * (b[..., 3] - b[..., 1])
    return sides.prod(1) / (area(boxes) + area(box) - sides.prod(1))


@jax.jit
@jax.value_and_grad
def surest(image, box, counts, least_iou):
    boxes, objectness, labels = rows_of(image)
    confidence = objectness * jnp.where(counts, labels, 0).max(1)
    meets = jax.lax.stop_gradient(iou(boxes, box)) >= least_iou
    return -jnp.log1p(-jnp.where(meets, confidence, 0).max())


def loss_and_gradient(image, box, labels, least_iou):
    loss, gradient = surest(image, jnp.array(box), jnp.isin(jnp.arange(80), jnp.array(labels)), least_iou)
    return None if loss == 0 else (loss, gradient)


def detect(image):
    boxes, objectness, probabilities = (np.asarray(part) for part in rows_of(image.astype(np.float32) / 255))
    labels, scores = probabilities.argmax(1), objectness * probabilities.max(1)
    for label in np.unique(labels):
        rows = np.where((labels == label) & (scores >= FLOOR))[0]
        rows = rows[np.argsort(-scores[rows], kind="stable")]
        while len(rows):
            yield label, scores[rows[0]], boxes[rows[0]]
            rows = rows[1:][np.asarray(iou(boxes[rows[1:]], boxes[rows[0]])) <= NMS_IOU]


scaleproof_detector.run(
    detect,
    name="yolox_nano",
    version=f"JAX {jax.__version__} on {jax.devices()[0].device_kind}",
    labels="coco80",
    files=[sys.argv[1]],
    deterministic=True,
    loss_and_gradient=loss_and_gradient,
)
