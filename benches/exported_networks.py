"""The networks of tests/data/exported, as their own frameworks export them, and what the frameworks find with them.

    python exported_networks.py CAPTURES OUT [NAME…]

CAPTURES: captures/skyline. OUT gets photos (PNG), networks (ONNX) and detections.json: for each network versions, labels, and of each photo the 30 best rows
(label from 0, score, x1, y1, x2, y2 in px), from the framework's own preparation of the photo to its own post-processing. The weights are random
(seeded) and as narrow as the configurations allow; the last layers are scaled so that some tens of boxes come out.

Made with Python 3.11, torch 2.15.0, torchvision 0.29.2, onnx 1.23.2, onnxscript 0.7.2, ultralytics 8.4.190, onnxslim 0.1.98, transformers 5.24.0, effdet 0.4.1, timm 1.0.31.
"""

import importlib.metadata
import json
import os
import pathlib
import sys

os.environ.update(YOLO_AUTOINSTALL="false", YOLO_OFFLINE="true", HF_HUB_OFFLINE="1")

import numpy as np
import onnx
import torch
from PIL import Image

torch.set_num_threads(1)
LABELS = ["car", "bus", "truck", "person", "dog"]
ROWS = 30


def photos(captures, out):
    """Three small ones of few colours: wide, near and tall."""
    opened = lambda name: Image.open(captures / f"{name}.jpg").convert("RGB")
    made = {
        "wide": opened("normal_000").resize((320, 240), Image.BOX),
        "near": opened("normal_003").crop((200, 150, 1064, 798)).resize((288, 216), Image.BOX),
        "tall": opened("normal_006").crop((300, 40, 831, 943)).resize((177, 301), Image.BOX),
    }
    for name, image in made.items():
        image.quantize(24, dither=0).save(out / f"{name}.png", optimize=True)
    return {f"{name}.png": Image.open(out / f"{name}.png").convert("RGB") for name in made}


# --- Random weights that find something ---------------------------------------------------------------------------------------------------

def calm(model):
    """Makes each filter the mean of itself: a random one answers to the last bit of a pixel, which depends on the program that resized the photo."""
    for m in model.modules():
        if isinstance(m, torch.nn.Conv2d) and max(m.kernel_size) > 1:
            m.weight.copy_(m.weight.sum((2, 3), keepdim=True).expand_as(m.weight) / m.weight[0, 0].numel())


def settle(model, run):
    """Gives each batch normalisation the mean of each channel and the variance of all of what it sees on the photos, layer after layer. (With a variance for each
    channel noise, which excites other channels than photos, would grow from layer to layer.)"""

    def take(module, inputs):
        module.running_mean.copy_(inputs[0].mean(dim=(0, 2, 3)))
        module.running_var.fill_(inputs[0].var(dim=(0, 2, 3), unbiased=False).mean() + 1e-2)

    is_norm = lambda m: isinstance(getattr(m, "running_mean", None), torch.Tensor)
    hooks = [m.register_forward_pre_hook(take) for m in model.modules() if is_norm(m)]
    run()
    for hook in hooks:
        hook.remove()


def spread(layer, run, mean, std, per_channel=False, top=None):
    """Scales a layer's weights so that its outputs on the photos have this mean and standard deviation; with `top` the mean is instead such
    that so many outputs are above a score of 0.3."""
    seen = []
    hook = layer.register_forward_hook(lambda _m, _i, out: seen.append(out.detach()))
    run()
    hook.remove()
    axis = -1 if isinstance(layer, torch.nn.Linear) else 1
    flat = torch.cat([o.movedim(axis, -1).reshape(-1, o.shape[axis]) for o in seen])
    m, s = (flat.mean(0), flat.std(0) + 1e-6) if per_channel else (flat.mean(), flat.std() + 1e-6)
    gain = torch.as_tensor(std / s)
    layer.weight.mul_(gain.reshape(-1, *[1] * (layer.weight.dim() - 1)) if per_channel else gain)
    layer.bias.copy_((layer.bias - m) * gain + mean)
    if top:
        # Of each photo, and for the one with the lowest scores.
        of_photos = [torch.cat([o[i].flatten() for o in seen]) for i in range(len(seen[0]))]
        last = min(((p - m.mean()) * gain.mean() + mean).topk(max(1, min(top // len(of_photos), p.numel() // 30))).values[-1] for p in of_photos)
        layer.bias.sub_(last + 0.85)


# --- Files --------------------------------------------------------------------------------------------------------------------------------

def keep(out, name, network, how, packages, detections, labels=LABELS, **saving):
    """Stores a network without its exporter's notes on nodes, which nothing runs, and adds its detections. A box without an area is none."""
    for part in [*network.graph.node, *network.graph.initializer, *network.graph.input, *network.graph.output]:
        part.doc_string = ""
        del part.metadata_props[:]
    del network.graph.value_info[:]
    onnx.save_model(network, out / f"{name}.onnx", **saving)
    best = lambda rows: sorted((r for r in rows if r[4] - r[2] > 0.01 and r[5] - r[3] > 0.01), key=lambda r: -r[1])[:ROWS]
    row = lambda r: [int(r[0]), round(float(r[1]), 5), *(round(float(v), 2) for v in r[2:])]
    file = out / "detections.json"
    state = json.loads(file.read_text()) if file.exists() else {}
    state[name] = {
        "versions": {p: importlib.metadata.version(p) for p in ["torch", "onnx", *packages]}, "how": how, "labels": labels,
        "photos": {photo: [row(r) for r in best(rows)] for photo, rows in detections.items()},
    }
    file.write_text(json.dumps(state, separators=(",", ":")) + "\n")


def rows_of(labels, scores, boxes):
    return [[l, s, *b] for l, s, b in zip(labels.tolist(), scores.tolist(), boxes.tolist())]


# --- Networks -----------------------------------------------------------------------------------------------------------------------------

def torchvision_ssd(images, out):
    import torchvision
    from torchvision.models.detection.anchor_utils import DefaultBoxGenerator
    from torchvision.models.detection.backbone_utils import BackboneWithFPN
    from torchvision.models.detection.ssd import SSD, SSDHead
    from torchvision.transforms.functional import to_tensor

    features, count, wide = torchvision.models.mobilenet_v2(width_mult=0.1).features[:14], len(LABELS) + 1, 8
    backbone = BackboneWithFPN(features, {"6": "0", "13": "1"}, [features[i].out_channels for i in (6, 13)], wide)
    boxes = DefaultBoxGenerator([[2], [2, 3], [2]], min_ratio=20, max_ratio=90)
    model = SSD(backbone, boxes, (320, 320), count, head=SSDHead([wide] * 3, boxes.num_anchors_per_location(), count)).eval()
    tensors = [to_tensor(image) for image in images.values()]
    run = lambda: model(tensors)
    calm(model)
    settle(model, run)
    last = lambda head: [[c for c in m.modules() if isinstance(c, torch.nn.Conv2d)][-1] for m in head.module_list]
    for layer in last(model.head.regression_head):
        spread(layer, run, 0.0, 1.0)
    for layer in last(model.head.classification_head):
        spread(layer, run, 0.0, 1.6)
        layer.bias.reshape(-1, count)[:, 0] += 4.5  # the background
    path, outputs = out / "torchvision_ssd.onnx", ["boxes", "scores", "labels"]
    # The way that torchvision's own tests export: a list of images, of any size.
    torch.onnx.export(
        model, ([tensors[0]],), str(path), dynamo=False, opset_version=17, input_names=["images"], output_names=outputs,
        dynamic_axes={"images": {1: "height", 2: "width"}, **{o: {0: "n"} for o in outputs}},
    )
    found = {name: model([to_tensor(image)])[0] for name, image in images.items()}
    detections = {name: rows_of(f["labels"] - 1, f["scores"], f["boxes"]) for name, f in found.items()}
    keep(out, "torchvision_ssd", onnx.load(path), "torch.onnx.export(model, ([image],), dynamo=False), height and width open", ["torchvision"], detections)


def effdet_grids(images, out):
    """The network's answers to one photo as constants: the network itself is too large to be stored."""
    from effdet import DetBenchPredict, EfficientDet, get_efficientdet_config
    from effdet.data import resolve_input_config
    from effdet.data.transforms import ImageToNumpy, ResizePad, resolve_fill_color

    config = get_efficientdet_config("efficientdet_d0")
    config.update(
        backbone_name="lcnet_035", backbone_args={}, image_size=[128, 128], num_classes=len(LABELS), fpn_channels=8, fpn_cell_repeats=1,
        box_class_repeats=1, max_detection_points=1000,
    )
    model = EfficientDet(config, pretrained_backbone=False)
    bench = DetBenchPredict(model).eval()
    usual = resolve_input_config({}, model_config=config)
    mean, std = (torch.tensor(usual[v]).reshape(1, 3, 1, 1) for v in ("mean", "std"))

    def prepared(image):
        """As `transforms_coco_eval` and the `PrefetchLoader` of effdet do it."""
        resized, notes = ResizePad(tuple(config.image_size), "bilinear", resolve_fill_color("mean", usual["mean"]))(image, {})
        x = torch.from_numpy(ImageToNumpy()(resized, {})[0])[None].float().sub_(mean * 255).div_(std * 255)
        return x, {"img_scale": torch.tensor([notes["img_scale"]]), "img_size": torch.tensor([[image.width, image.height]]).float()}

    inputs = torch.cat([prepared(image)[0] for image in images.values()])
    run = lambda: model(inputs)
    calm(model)
    settle(model, run)
    spread(model.class_net.predict.conv_pw, run, 0.0, 0.7, top=1500)
    spread(model.box_net.predict.conv_pw, run, 0.0, 0.4)
    x, info = prepared(images["tall.png"])
    scores, offsets = model(x)
    named = {f"{what}_{i}": grid.numpy() for what, grids in [("scores", scores), ("offsets", offsets)] for i, grid in enumerate(grids)}
    h = onnx.helper
    network = h.make_model(h.make_graph(
        [h.make_node("Identity", [f"{n}_constant"], [n]) for n in named], "grids", [h.make_tensor_value_info("input", 1, list(x.shape))],
        [h.make_tensor_value_info(n, 1, list(v.shape)) for n, v in named.items()],
        [onnx.numpy_helper.from_array(v, f"{n}_constant") for n, v in named.items()],
    ), opset_imports=[h.make_opsetid("", 17)], ir_version=8)
    found = [[r[5] - 1, r[4], *r[:4]] for r in bench(x, info)[0].tolist() if r[4] > 0]
    keep(out, "effdet_grids", network, "the answers of EfficientDet to tall.png, as constants", ["effdet", "timm"], {"tall.png": found})


def yolo26(images, out):
    import yaml
    from ultralytics import YOLO
    from ultralytics.data.augment import LetterBox
    from ultralytics.nn.tasks import yaml_model_load

    config, file = yaml_model_load("yolo26n.yaml"), out / "yolo26n.yaml"
    config.update(scales={"n": [0.25, 0.0625, 128]}, nc=len(LABELS), scale="n")
    file.write_text(yaml.safe_dump(config))
    yolo, side = YOLO(str(file), task="detect"), 160
    model = yolo.model.eval()
    model.names = dict(enumerate(LABELS))
    bgr = lambda image: np.asarray(image)[..., ::-1].copy()
    boxed = lambda image: np.ascontiguousarray(LetterBox((side, side), auto=False)(image=bgr(image))[..., ::-1].transpose(2, 0, 1))
    inputs = torch.cat([torch.from_numpy(boxed(image))[None].float() / 255 for image in images.values()])
    run = lambda: model(inputs)
    calm(model)
    settle(model, run)
    head = model.model[-1]
    for branch in [*head.cv3, *head.one2one_cv3]:
        spread(branch[-1], run, 0.0, 1.5, top=400)
    for branch in [*head.cv2, *head.one2one_cv2]:
        branch[-1].weight.abs_()
        spread(branch[-1], run, 1.0, 0.5)
        # Distances themselves: above 1 whatever the image, since SiLU is above -0.28.
        branch[-1].bias.copy_(1 + 0.28 * branch[-1].weight.sum((1, 2, 3)))
    saved = out / "yolo26.pt"
    yolo.ckpt = yolo.ckpt or {}
    yolo.save(saved)
    # None is the exporter's default, a table for a suppression outside; False the head that needs none.
    for name, nms in [("yolo26_end2end", False), ("yolo26", None)]:
        exported = onnx.load(YOLO(saved).export(format="onnx", imgsz=side, device="cpu", nms=nms))
        predictor = YOLO(saved)
        settings = dict(imgsz=side, conf=0.001, iou=0.7, max_det=300, rect=False, nms=nms, verbose=False, device="cpu")
        found = {photo: predictor.predict(bgr(image), **settings)[0].boxes for photo, image in images.items()}
        detections = {photo: rows_of(f.cls, f.conf, f.xyxy) for photo, f in found.items()}
        # The file names its labels.
        keep(out, name, exported, f"YOLO.export(format='onnx', imgsz={side}, nms={nms})", ["ultralytics", "onnxslim"], detections, labels=None)
    for rest in [file, saved]:
        rest.unlink()


def tiny_resnet(kind, **more):
    return kind(embedding_size=8, hidden_sizes=[8, 16, 16, 16], depths=[1] * 4, layer_type="basic", **more)


FEW = dict(id2label=dict(enumerate(LABELS)), label2id={n: i for i, n in enumerate(LABELS)})


def detr(images, out):
    import transformers as t

    config = t.DetrConfig(
        use_timm_backbone=False, use_pretrained_backbone=False, backbone=None, backbone_config=tiny_resnet(t.ResNetConfig, out_features=["stage4"]), d_model=16,
        encoder_layers=1, decoder_layers=1, encoder_ffn_dim=16, decoder_ffn_dim=16, encoder_attention_heads=2, decoder_attention_heads=2, num_queries=50, **FEW,
    )

    def liven(model, run, _count):
        spread(model.class_labels_classifier, run, 0.0, 2.0, per_channel=True)
        model.class_labels_classifier.bias[-1] += 1.0
        spread(model.bbox_predictor.layers[-1], run, -0.5, 1.0, per_channel=True)

    processor = t.DetrImageProcessor(size=dict(shortest_edge=160, longest_edge=266))
    # In two files, as the exporter writes it.
    beside = dict(save_as_external_data=True, location="detr.onnx.data", size_threshold=256)
    of_transformers("detr", t.DetrForObjectDetection(config), processor, liven, images, out, are_sides_open=True, **beside)


def rtdetr_v2(images, out):
    import transformers as t

    config = t.RTDetrV2Config(
        backbone_config=tiny_resnet(t.RTDetrResNetConfig, out_features=["stage2", "stage3", "stage4"]), d_model=16, encoder_hidden_dim=16,
        encoder_in_channels=[16] * 3, decoder_in_channels=[16] * 3, feat_strides=[8, 16, 32], encoder_ffn_dim=16, decoder_ffn_dim=16, decoder_layers=2,
        encoder_attention_heads=2, decoder_attention_heads=2, num_queries=50, decoder_n_points=2, hidden_expansion=0.25, **FEW,
    )

    def liven(model, run, count):
        spread(model.model.enc_score_head, run, 0.0, 1.5, top=200)
        torch.nn.init.normal_(model.model.enc_bbox_head.layers[-1].weight, std=0.3)
        spread(model.model.decoder.class_embed[-1], run, 0.0, 0.6, top=50 * count)

    processor = t.RTDetrImageProcessor(size=dict(height=160, width=160))
    of_transformers("rtdetr_v2", t.RTDetrV2ForObjectDetection(config), processor, liven, images, out, are_sides_open=False)


def of_transformers(name, model, processor, liven, images, out, are_sides_open, **saving):
    from transformers.exporters.exporter_onnx import OnnxConfig, OnnxExporter

    model.eval()
    prepared = lambda image: processor(images=image, return_tensors="pt")["pixel_values"]
    inputs = [prepared(image) for image in images.values()]
    batch = torch.cat([x for x in inputs if x.shape == inputs[0].shape])
    run = lambda: model(pixel_values=batch)
    calm(model)
    settle(model, run)
    liven(model, run, len(inputs))
    open_sides = {"pixel_values": {2: torch.export.Dim.AUTO, 3: torch.export.Dim.AUTO}} if are_sides_open else None
    folder = out / f"{name}_transformers"
    OnnxExporter().export(model, {"pixel_values": inputs[0]}, config=OnnxConfig(dynamic_shapes=open_sides)).save_pretrained(folder)
    detections = {}
    for photo, image in images.items():
        answer, size = model(pixel_values=prepared(image)), (image.height, image.width)
        found = processor.post_process_object_detection(answer, threshold=0.001, target_sizes=[size])[0]
        detections[photo] = rows_of(found["labels"], found["scores"], found["boxes"])
    how = f"transformers' OnnxExporter, {'height and width open' if are_sides_open else 'OnnxConfig()'}"
    keep(out, name, onnx.load(folder / "model.onnx"), how, ["transformers", "onnxscript"], detections, **saving)


def main():
    captures, out, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    out.mkdir(parents=True, exist_ok=True)
    with torch.no_grad():
        images = photos(captures, out)
        for make in [yolo26, detr, rtdetr_v2, torchvision_ssd, effdet_grids]:
            if not names or make.__name__ in names:
                torch.manual_seed(42)
                make(images, out)


if __name__ == "__main__":
    main()
