"""docs/report.png: a report as three columns of one picture.

    python report_picture.py REPORT_HTML PNG

Needs Chromium (or $CHROMIUM) and Pillow.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageChops

# Of the page in its three columns, and of the picture.
PAGE_PX, PICTURE_PX = 3500, 1938
STYLE = f"""<style>body {{ max-width: none; width: {PAGE_PX - 60}px; margin: 30px; columns: 3; column-gap: 70px }} main {{ max-width: none }}
section {{ break-inside: avoid-column }} #outcomes, #photos {{ break-before: column }} #definitions, #provenance {{ display: none }} ::-webkit-scrollbar {{ display: none }}</style>"""

page, picture = pathlib.Path(sys.argv[1]), sys.argv[2]
with tempfile.TemporaryDirectory() as folder:
    shown, shot = pathlib.Path(folder) / "page.html", pathlib.Path(folder) / "page.png"
    shown.write_text(page.read_text().replace("</head>", STYLE + "</head>"))
    browser = os.environ.get("CHROMIUM", "chromium")
    options = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile", f"--screenshot={shot}", f"--window-size={PAGE_PX},6000", shown.as_uri()]
    subprocess.run([browser, *options], check=True, stderr=subprocess.DEVNULL)
    whole = Image.open(shot).convert("RGB")
    bottom = ImageChops.difference(whole, Image.new("RGB", whole.size, whole.getpixel((0, 0)))).getbbox()[3]
    cut = whole.crop((0, 0, PAGE_PX, bottom + 30))
    cut.resize((PICTURE_PX, cut.height * PICTURE_PX // PAGE_PX), Image.LANCZOS).quantize(256, method=Image.Quantize.FASTOCTREE).save(picture, optimize=True)
