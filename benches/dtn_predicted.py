"""Frames as a trained DTN predicts them: of each view its grey image alone is looked at, and every flat colour is what the network makes of it. `attack run`
on such frames is the attack of the paper, which sees the renderer through its network only: the closed form it fits to a view's colours stands for the network.

    dtn_predicted.py NETWORK FRAMES FOLDER [HEX…]
    dtn_predicted.py NETWORK FRAMES error

NETWORK: what `attack train-dtn` wrote, with one reference colour, the ResNet encoder and the transformer of DTN. FRAMES have views in that colour. FOLDER gets
each view in the colours HEX. With `error`, FRAMES have further colours, and the network's error in them is written as JSON: binary cross-entropy, mean squared
and mean absolute error over whole images that are black outside the paint, as the paper has them, and mean squared error over the paint. Needs PyTorch, numpy
and Pillow.
"""

import hashlib
import json
import shutil
import struct
import sys
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from PIL import Image

MAGIC = b"scaleproof dtn 1\n"
# As crates/frames/src/surrogate/dtn has them: channels of the encoder's stages and at full size, margin and alignment of the window around the paint.
WIDTHS = (16, 32, 64, 96)
FULL_SIZE_WIDTH = 24
MARGIN_PX = 4
ALIGN_PX = 16
COLOURS = ("000000", "404040", "808080", "c0c0c0", "ffffff")


class Postcard:
    """Reads the file's format, https://postcard.jamesmunns.com: numbers of variable length, lists that begin with theirs."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count : self.at]

    def number(self):
        value, shift = 0, 0
        while True:
            byte = self.take(1)[0]
            value, shift = value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value

    def float64(self):
        return struct.unpack("<d", self.take(8))[0]

    def list(self, item):
        return [item() for _ in range(self.number())]

    def floats(self):
        return np.frombuffer(self.take(4 * self.number()), "<f4")


class Network:
    """The running mean of the weights, and what they make of a view."""

    def __init__(self, path):
        data = Path(path).read_bytes()
        head, rest = data[: len(MAGIC)], data[len(MAGIC) :]
        sum_, _, content = rest.partition(b"\n")
        if head != MAGIC or hashlib.sha256(content).hexdigest() != sum_.decode():
            sys.exit(f"{path} is no network that attack train-dtn wrote")
        read = Postcard(content)
        encoder, self.depth, transformer = read.number(), read.number(), read.number()
        references = read.list(lambda: tuple(read.take(3)))
        if encoder or transformer or len(references) != 1:
            sys.exit(f"{path} has not one reference colour, the ResNet encoder and the transformer of DTN")
        self.reference = references[0]
        read.number()  # the seed
        read.take(read.number())  # of which data
        self.steps, self.seconds = read.number(), read.float64()
        read.list(lambda: (read.number(), read.float64(), read.float64(), read.take(1) == b"\1" and read.float64()))
        read.float64(), read.number()  # losses since
        read.list(read.floats)
        shapes = [shape for conv in self.convolutions() for shape in (conv, conv[:1])]
        lists = read.list(read.floats)
        self.weights = [torch.tensor(values).reshape(shape) for values, shape in zip(lists, shapes, strict=True)]

    def convolutions(self):
        """Shapes of the kernels in the order in which an image passes them."""
        below = lambda i: WIDTHS[i - 1] if i else 3
        wide = lambda i: WIDTHS[i - 1] if i else FULL_SIZE_WIDTH
        for i in range(self.depth):
            yield (WIDTHS[i], below(i), 3, 3)
            yield (WIDTHS[i], WIDTHS[i], 3, 3)
            yield (WIDTHS[i], WIDTHS[i], 3, 3)
        for i in reversed(range(self.depth)):
            yield (wide(i), WIDTHS[i] + below(i), 3, 3)
        yield (12, FULL_SIZE_WIDTH, 1, 1)

    def maps(self, reference):
        """TF of an image (3, height, width), sRGB 0 to 1 and 0 outside the paint: 4 maps of 3 channels."""
        layers = iter(zip(self.weights[::2], self.weights[1::2]))

        def next_layer(x, stride=1):
            kernel, bias = next(layers)
            return F.conv2d(x, kernel, bias, stride, kernel.shape[-1] // 2)

        x = torch.from_numpy(reference)[None]
        sizes = []
        for _ in range(self.depth):
            sizes.append(x)
            x = F.relu(next_layer(x, 2))
            x = F.relu(x + next_layer(F.relu(next_layer(x))))
        for size in reversed(sizes):
            x = F.relu(next_layer(torch.cat([x.repeat_interleave(2, 2).repeat_interleave(2, 3), size], 1)))
        return next_layer(x)[0].reshape(4, 3, *reference.shape[1:]).numpy()

    @torch.no_grad()
    def view(self, image, mask):
        """A function of a colour, 8-bit sRGB, that gives the view's image in it (height, width, 3), sRGB 0 to 1; outside the paint it is `image`."""
        paint = mask >= 128
        rows, columns = np.nonzero(paint)
        low = np.array([rows.min(), columns.min()])
        size = np.array([rows.max(), columns.max()]) - low + 1
        window = -(-(size + 2 * MARGIN_PX) // ALIGN_PX) * ALIGN_PX
        row, column = np.stack([rows, columns]) - (low - (window - size) // 2)[:, None]
        given = np.zeros((3, *window), np.float32)
        given[:, row, column] = image[paint].T
        subtract, add, multiply, bias = self.maps(given)[:, :, row, column]

        def predict(colour):
            eta = np.asarray(colour, np.float32)[:, None] / 255
            x = np.maximum((np.maximum(eta - subtract, 0) + add) * multiply + bias, 0)
            out = image.copy()
            out[paint] = x.T.clip(0, 1)
            return out

        return predict


def read_image(path):
    return np.asarray(Image.open(path).convert("RGB"), np.float32) / 255


def colour(text):
    return tuple(bytes.fromhex(text))


def views(folder):
    """The list, and the frames of each view: one pose in one light."""
    frames = json.loads((folder / "frames.json").read_text())
    found = {}
    for frame in frames["frames"]:
        found.setdefault((frame["paint_mask"], frame["place"]), {})[tuple(frame["paint"]["flat_rgb"])] = frame
    return frames, list(found.values())


def opened(network, folder, view):
    """Of a view: its frame in the reference colour, the mask, and the network's function."""
    frame = view[network.reference]
    mask = np.asarray(Image.open(folder / frame["paint_mask"]))
    return frame, mask, network.view(read_image(folder / frame["rgb"]), mask)


def predict(network, folder, out, colours):
    frames, all_views = views(folder)
    (out / "rgb").mkdir(parents=True, exist_ok=True)
    shutil.copytree(folder / "views", out / "views", dirs_exist_ok=True)
    listed = []
    for view in all_views:
        frame, _, function = opened(network, folder, view)
        base = frame["name"].rpartition("_")[0]
        for text in colours:
            name = f"{base}_{text}"
            # 255 would count as clipped, and the closed form, fitted to the darker colours alone, would bend anywhere beyond them.
            pixels = np.rint(255 * function(colour(text))).clip(0, 254).astype(np.uint8)
            Image.fromarray(pixels).save(out / "rgb" / f"{name}.png")
            new = {**frame, "name": name, "rgb": f"rgb/{name}.png", "paint": {"flat_rgb": list(colour(text))}}
            new.pop("linear", None)
            listed.append(new)
    frames.pop("linear_max", None)
    frames |= {"made_by": "benches/dtn_predicted.py: predicted by a trained DTN from one grey image of each view", "frames": listed}
    (out / "frames.json").write_text(json.dumps(frames))


def error(network, folder):
    whole, of_paint, images = [], [], 0
    for view in views(folder)[1]:
        _, mask, function = opened(network, folder, view)
        for rgb, frame in view.items():
            if rgb == network.reference:
                continue
            truth, found = read_image(folder / frame["rgb"]), function(rgb)
            paint, inside = mask >= 128, found.clip(1e-4, 1 - 1e-4)
            entropy = -(truth * np.log(inside) + (1 - truth) * np.log(1 - inside))
            squared = (found - truth) ** 2
            # Outside the paint the paper's images are black, which costs nothing.
            whole.append((entropy[paint].sum() / entropy.size, squared[paint].sum() / squared.size, np.abs(found - truth)[paint].sum() / squared.size))
            of_paint.append(squared[paint].mean())
            images += 1
    bce, mse, mae = np.mean(whole, 0)
    return {"bce": bce, "mse": mse, "mae": mae, "mse_paint": np.mean(of_paint), "images": images, "steps": network.steps, "seconds": network.seconds}


if __name__ == "__main__":
    # Threads that wait for each other cost more than they gain on a network so small.
    torch.set_num_threads(1)
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    network, folder = Network(sys.argv[1]), Path(sys.argv[2])
    if sys.argv[3] == "error":
        print(json.dumps({key: float(value) for key, value in error(network, folder).items()}))
    else:
        predict(network, folder, Path(sys.argv[3]), sys.argv[4:] or COLOURS)
