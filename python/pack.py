"""Packs a folder with the package into a wheel: `pack.py FOLDER VERSION OUTPUT`, for `.ci/wheel.sh`.

The wheel is for every CPython from 3.10 on (the module uses its stable ABI) and for a C library as new as this machine's. The same content gives the
same bytes. Format: the specification "Binary distribution format" of the Python packaging guide.
"""

import base64
import hashlib
import os
import platform
import sys
import zipfile
from pathlib import Path

folder, version, output = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")
tag = f"cp310-abi3-manylinux_{glibc}_{platform.machine()}"
info = f"scaleproof-{version}.dist-info"

METADATA = f"""Metadata-Version: 2.4
Name: scaleproof
Version: {version}
Summary: Print an adversarial pattern on a 1:10 model, photograph it, and get numbers you can defend.
License-Expression: MIT OR Apache-2.0
Requires-Python: >=3.10
Requires-Dist: numpy>=1.22
Requires-Dist: onnxruntime>=1.17
Provides-Extra: torch
Requires-Dist: torch; extra == "torch"
Description-Content-Type: text/markdown

{Path(__file__).with_name("README.md").read_text()}"""
(folder / info / "METADATA").write_text(METADATA)
(folder / info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: scaleproof\nRoot-Is-Purelib: false\nTag: {tag}\n")
(folder / info / "entry_points.txt").write_text("[console_scripts]\nscaleproof = scaleproof.__main__:main\n")

output.mkdir(parents=True, exist_ok=True)
wheel = output / f"scaleproof-{version}-{tag}.whl"
partial = wheel.with_suffix(".partial")
record = ""
with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        name, content = path.relative_to(folder).as_posix(), path.read_bytes()
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
        about = zipfile.ZipInfo(name)
        about.external_attr, about.compress_type = 0o100644 << 16, zipfile.ZIP_DEFLATED
        archive.writestr(about, content)
    archive.writestr(zipfile.ZipInfo(f"{info}/RECORD"), record + f"{info}/RECORD,,\n")
partial.replace(wheel)
print(wheel)
