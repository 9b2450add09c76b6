"""The sixteen photos of captures/skyline that figures are of, as a session of their own: the plain model and the random pattern.  two_textures.py SKYLINE FOLDER"""

import json
import shutil
import sys
from pathlib import Path

skyline, folder = map(Path, sys.argv[1:])
shutil.copytree(skyline, folder, ignore=shutil.ignore_patterns("two_targets_*"), dirs_exist_ok=True)
for name in ["session.json", "truth.json"]:
    listed = json.loads((skyline / name).read_text())
    listed["photos"] = [photo for photo in listed["photos"] if photo["file"].startswith(("normal_", "random_"))]
    (folder / name).write_text(json.dumps(listed, indent=1))
