"""Camera files as other programs write them, and where those programs see points: tests/data/cases/cameras.

pip install numpy opencv-python-headless pyyaml pycolmap
"""
import json
from pathlib import Path

import cv2
import numpy as np
import pycolmap
import yaml

HERE = Path(__file__).parent / "cases/cameras"
SIZE = (1280, 960)
K = np.array([[1180.0, 0, 649.25], [0, 1181.5, 474.75], [0, 0, 1]])
BROWN = np.array([-0.05, 0.01, 1e-4, -2e-4, 3e-3])
FISHEYE = np.array([0.02, -0.004, 0.0015, -0.0004])
RAYS = np.array([[x, y, 1.0] for x in (-0.5, -0.2, 0.0, 0.31, 0.5) for y in (-0.38, 0.0, 0.1, 0.38)])
truth = {}


def remember(name, pixels):
    """Pixels as OpenCV counts them: (0, 0) is the centre of the first."""
    truth[name] = {"rays": RAYS.tolist(), "pixels": np.asarray(pixels).reshape(-1, 2).tolist()}


def brown(k=K, d=BROWN):
    return cv2.projectPoints(RAYS, np.zeros(3), np.zeros(3), k, d)[0]


def fisheye():
    return cv2.fisheye.projectPoints(RAYS.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), K, FISHEYE)[0]


# OpenCV's FileStorage, in its three notations; numbers of images that are floats.
for ending in ("xml", "yaml", "json"):
    for what, size in (("", SIZE), ("_float", [float(s) for s in SIZE])):
        name = f"opencv{what}.{ending}"
        storage = cv2.FileStorage(str(HERE / name), cv2.FILE_STORAGE_WRITE)
        storage.write("image_width", size[0])
        storage.write("image_height", size[1])
        storage.write("camera_matrix", K)
        storage.write("distortion_coefficients", BROWN)
        storage.release()
        remember(name, brown())

# What scripts dump after cv2.calibrateCamera.
(HERE / "pyyaml.yaml").write_text(
    yaml.dump({"image_size": list(SIZE), "camera_matrix": K.tolist(), "dist_coeff": [BROWN.tolist()]})
)
remember("pyyaml.yaml", brown())
(HERE / "pyyaml_tuple.yaml").write_text(
    yaml.dump({"width": 1280, "height": 960, "mtx": K.tolist(), "dist": tuple(BROWN.tolist())})
)
remember("pyyaml_tuple.yaml", brown())
(HERE / "python.json").write_text(
    json.dumps({"image_width": 1280, "image_height": 960, "K": K.tolist(), "D": BROWN.tolist()})
)
remember("python.json", brown())

# `ros2 topic echo --once /camera_info` and ROS 1's `rostopic echo`: PyYAML's block lists, then the end of the message.
message = {
    "header": {"stamp": {"sec": 1700000000, "nanosec": 0}, "frame_id": "camera"},
    "height": 960,
    "width": 1280,
    "distortion_model": "plumb_bob",
    "d": BROWN.tolist(),
    "k": K.ravel().tolist(),
    "r": np.eye(3).ravel().tolist(),
    "p": np.c_[K, np.zeros(3)].ravel().tolist(),
    "binning_x": 0,
    "binning_y": 0,
    "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False},
}
echo = yaml.dump(message, sort_keys=False)
(HERE / "ros2_echo.yaml").write_text(f"{echo}---\n{echo}---\n")
remember("ros2_echo.yaml", brown())
upper = {key.upper() if len(key) == 1 else key: value for key, value in message.items()}
(HERE / "ros1_echo.yaml").write_text(yaml.dump(upper, sort_keys=False, default_flow_style=None) + "---\n")
remember("ros1_echo.yaml", brown())
fish = message | {"distortion_model": "equidistant", "d": FISHEYE.tolist()}
(HERE / "ros2_echo_fisheye.yaml").write_text(yaml.dump(fish, sort_keys=False) + "---\n")
remember("ros2_echo_fisheye.yaml", fisheye())

# EuRoC's sensor.yaml and a Kalibr chain of two, both dumped by PyYAML.
pinhole = [1180.0, 1181.5, 649.25, 474.75]
euroc = {
    "sensor_type": "camera",
    "T_BS": {"cols": 4, "rows": 4, "data": np.eye(4).ravel().tolist()},
    "rate_hz": 20,
    "resolution": list(SIZE),
    "camera_model": "pinhole",
    "intrinsics": pinhole,
    "distortion_model": "radial-tangential",
    "distortion_coefficients": BROWN[:4].tolist(),
}
(HERE / "euroc.yaml").write_text("# General sensor definitions.\n" + yaml.dump(euroc, default_flow_style=None))
remember("euroc.yaml", brown(d=BROWN[:4]))
one = {"camera_model": "pinhole", "intrinsics": pinhole, "resolution": list(SIZE), "rostopic": "/cam0/image_raw"}
chain = {
    "cam0": one | {"distortion_model": "radtan", "distortion_coeffs": BROWN[:4].tolist(), "cam_overlaps": [1]},
    "cam1": one
    | {
        "distortion_model": "equidistant",
        "distortion_coeffs": FISHEYE.tolist(),
        "T_cn_cnm1": np.eye(4).tolist(),
        "cam_overlaps": [0],
    },
}
(HERE / "kalibr_two.yaml").write_text(yaml.safe_dump(chain, default_flow_style=None))
remember("kalibr_two.yaml#cam0", brown(d=BROWN[:4]))
remember("kalibr_two.yaml#cam1", fisheye())

# COLMAP counts from the corner of the first pixel.
f, cx, cy = 1180.0, 649.25, 474.75
models = {
    "SIMPLE_PINHOLE": [f, cx, cy],
    "PINHOLE": pinhole,
    "SIMPLE_RADIAL": [f, cx, cy, -0.05],
    "RADIAL": [f, cx, cy, -0.05, 0.01],
    "OPENCV": pinhole + BROWN[:4].tolist(),
    "OPENCV_FISHEYE": pinhole + FISHEYE.tolist(),
    "FULL_OPENCV": pinhole + [-0.05, 0.01, 1e-4, -2e-4, 3e-3, 0.02, -0.01, 0.001],
    "SIMPLE_RADIAL_FISHEYE": [f, cx, cy, 0.02],
    "RADIAL_FISHEYE": [f, cx, cy, 0.02, -0.004],
}
reconstruction = pycolmap.Reconstruction()
for number, (model, params) in enumerate(models.items(), 1):
    camera = pycolmap.Camera(model=model, width=SIZE[0], height=SIZE[1], params=params, camera_id=number)
    reconstruction.add_camera(camera)
    remember(f"colmap.txt#{number}", camera.img_from_cam(RAYS) - 0.5)
folder = HERE / "colmap"
folder.mkdir(exist_ok=True)
reconstruction.write_text(str(folder))
(folder / "cameras.txt").rename(HERE / "colmap.txt")
for rest in folder.iterdir():
    rest.unlink()
folder.rmdir()

# NeRF's transforms.json as colmap2nerf.py of instant-ngp fills it: from COLMAP, so from the corner, too.
nerf = {
    "camera_angle_x": 2 * np.arctan(SIZE[0] / 2 / K[0, 0]),
    "camera_angle_y": 2 * np.arctan(SIZE[1] / 2 / K[1, 1]),
    "fl_x": K[0, 0],
    "fl_y": K[1, 1],
    "k1": BROWN[0],
    "k2": BROWN[1],
    "k3": 0,
    "k4": 0,
    "p1": BROWN[2],
    "p2": BROWN[3],
    "is_fisheye": False,
    "cx": cx,
    "cy": cy,
    "w": 1280.0,
    "h": 960.0,
    "aabb_scale": 4,
    "frames": [{"file_path": "images/0001.jpg", "sharpness": 30.5, "transform_matrix": np.eye(4).tolist()}],
}
(HERE / "transforms.json").write_text(json.dumps(nerf, indent=2))
corner = K - np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])
remember("transforms.json", brown(corner, BROWN[:4]))

(HERE / "truth.json").write_text(json.dumps(truth) + "\n")
