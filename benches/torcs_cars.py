"""Cars of the game TORCS as OBJ files that `attack render` takes: bodies of the game, wheels as plain discs where its settings put them.

    torcs_cars.py CARS FOLDER

CARS: the folder `usr/share/games/torcs/cars` of Debian's package torcs-data (its files `.acc` are AC3D's text with strips of triangles). FOLDER gets, for each
car of NAMES, NAME.obj, .mtl and .png: material `paint` is what a print would cover, `rest` keeps the game's image. In the game's metres, front +x, top +y.
Needs Pillow.
"""

import math
import re
import sys
from pathlib import Path

from PIL import Image

# Parts of the GT cars that are painted, by the beginning of their names.
PAINTED = ("CARBODY", "ROOFOUTSIDE", "REARBUMPER", "MESH")
NAMES = ("p406", "car1-trb1", "car4-trb1")
# Of a wheel's drum, and the share of its radius that is rim.
CORNERS = 24
RIM = 0.65


def parts(path):
    """(name, vertices, strips) of each part; a strip is a list of (vertex, u, v)."""
    lines = iter(path.read_text(errors="replace").splitlines())
    found = []
    for line in lines:
        word, _, rest = line.partition(" ")
        if word == "OBJECT":
            found.append(["", [], []])
        elif word == "name":
            found[-1][0] = rest.strip('"')
        elif word == "numvert":
            found[-1][1] = [tuple(map(float, next(lines).split()[:3])) for _ in range(int(rest))]
        elif word == "refs":
            corners = (next(lines).split() for _ in range(int(rest)))
            found[-1][2].append([(int(c[0]), float(c[1]), float(c[2])) for c in corners])
    return found


def triangles(strip):
    """Of a strip, every second one turned round, so that all have the same side outside."""
    for i in range(len(strip) - 2):
        a, b, c = strip[i : i + 3]
        if len({a[0], b[0], c[0]}) == 3:
            yield (a, b, c) if i % 2 == 0 else (b, a, c)


def is_paint(image, corners):
    """Whether a triangle shows the livery of the p406, light blue with an orange strip: its windows, lights and floor are on the same image."""
    u, v = (sum(c[k] for c in corners) / 3 for k in (1, 2))
    x, y = int(u % 1 * (image.width - 1)), int((1 - v % 1) * (image.height - 1))
    red, green, blue = image.getpixel((x, y))
    return (blue > 200 and red < 190) or (red > 200 and 60 < green < 150 and blue < 80)


def setting(xml, section, name):
    """A number of the game's settings."""
    found = re.search(rf'<section name="{section}">.*?<attnum name="{name}"[^>]*val="([^"]+)"', xml, re.S)
    if not found:
        sys.exit(f"no {name} in {section}")
    return float(found.group(1))


def wheels(xml):
    """(x, z, y, radius, width) of the four, in metres."""
    for end in ("Front", "Rear"):
        for side in ("Right", "Left"):
            wheel = f"{end} {side} Wheel"
            width = setting(xml, wheel, "tire width") / 1000
            radius = setting(xml, wheel, "rim diameter") * 0.0254 / 2 + width * setting(xml, wheel, "tire height-width ratio")
            ground = -setting(xml, wheel, "ride height") / 1000
            # The settings' y is to the left, the mesh's z to the right.
            yield setting(xml, f"{end} Axle", "xpos"), -setting(xml, wheel, "ypos"), ground + radius, radius, width


class Obj:
    """An OBJ file as it grows."""

    def __init__(self):
        self.points, self.images, self.faces = [], [], {"paint": [], "rest": [], "tyre": [], "rim": []}

    def add(self, material, corners):
        """One polygon of (point, (u, v))."""
        at = len(self.points) + 1
        self.points += [point for point, _ in corners]
        self.images += [image for _, image in corners]
        self.faces[material].append(range(at, at + len(corners)))

    def wheel(self, x, z, y, radius, width):
        """A drum with a rim on both faces."""
        turn = [2 * math.pi * k / CORNERS for k in range(CORNERS)]
        ring = lambda r, z: [((x + r * math.cos(t), y + r * math.sin(t), z), (0, 0)) for t in turn]
        left, right = ring(radius, z - width / 2), ring(radius, z + width / 2)
        for k in range(CORNERS):
            self.add("tyre", [left[k], left[k - 1], right[k - 1], right[k]])
        for side in (-1, 1):
            for material, r, out in (("tyre", radius, 0), ("rim", RIM * radius, 0.01)):
                face = ring(r, z + side * (width / 2 + out))
                self.add(material, face if side > 0 else face[::-1])

    def write(self, path):
        """The file and its materials."""
        colours = {"paint": "0.5 0.5 0.5", "rest": "1 1 1", "tyre": "0.02 0.02 0.02", "rim": "0.4 0.4 0.4"}
        texts = [f"newmtl {name}\nKd {colour}\n" for name, colour in colours.items()]
        texts[1] += f"map_Kd {path.stem}.png\n"
        path.with_suffix(".mtl").write_text("".join(texts))
        with path.open("w") as file:
            file.write(f"mtllib {path.stem}.mtl\n")
            file.writelines("v {:.6f} {:.6f} {:.6f}\n".format(*p) for p in self.points)
            file.writelines("vt {:.6f} {:.6f}\n".format(*i) for i in self.images)
            for material, faces in self.faces.items():
                file.write(f"usemtl {material}\n")
                file.writelines("f " + " ".join(f"{i}/{i}" for i in face) + "\n" for face in faces)


def convert(folder, out):
    """One car."""
    name = folder.name
    image = Image.open(folder / f"{name}.rgb").convert("RGB")
    image.save(out / f"{name}.png")
    obj = Obj()
    for part, points, strips in parts(folder / f"{name}.acc"):
        for strip in strips:
            for corners in triangles(strip):
                painted = is_paint(image, corners) if name == "p406" else part.startswith(PAINTED)
                obj.add("paint" if painted else "rest", [(points[c[0]], c[1:]) for c in corners])
    for wheel in wheels((folder / f"{name}.xml").read_text(errors="replace")):
        obj.wheel(*wheel)
    obj.write(out / f"{name}.obj")
    length = max(p[0] for p in obj.points) - min(p[0] for p in obj.points)
    print(f"{name}: {len(obj.faces['paint'])} painted triangles, {100 * length:.0f} mm at 1:10")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    cars, out = map(Path, sys.argv[1:])
    out.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        convert(cars / name, out)
