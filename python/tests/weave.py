"""A detector that is a formula: it sees the model the better, the more the image is like a fixed weave. As a program it gives boxes and gradients."""

import numpy


def loss_and_gradient(image):
    """−ln(1 − C) with C = σ(z), and its derivative by each number of the image."""
    pixels = numpy.arange(image.shape[0] * image.shape[1]).reshape(*image.shape[:2], 1)
    weave = numpy.sin(0.37 * pixels + numpy.arange(3)) + 0.4
    scale = 40 / weave.size
    z = scale * (weave * (image.astype(numpy.float64) - 0.5)).sum()
    return numpy.logaddexp(0, z), scale * weave / (1 + numpy.exp(-z))


if __name__ == "__main__":
    import scaleproof_detector

    scaleproof_detector.run(
        lambda image: [("car", 0.5, (0, 0, image.shape[1], image.shape[0]))],
        name="weave",
        version="1",
        labels=["car"],
        deterministic=True,
        loss_and_gradient=lambda image, box, labels, least_iou: loss_and_gradient(image),
    )
