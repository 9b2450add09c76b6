"""The renderer in PyTorch against the library's; run by the system's Python, whose PyTorch needs no graphics card: python3 in_torch.py OUTPUT."""

import math
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy
import torch
from weave import loss_and_gradient

import scaleproof
from scaleproof.torch import render

HERE, OUT = Path(__file__).parent, Path(sys.argv[1])
HOME, CELLS, TILE_MM, STEPS = HERE.parents[1], 16, 480.0, 4
FRAMES = HOME / "captures/skyline_frames"
frames = scaleproof.Frames(FRAMES)


def views_in(form):
    return [frames.view(index, cells=CELLS, tile_mm=TILE_MM, form=form) for index in range(len(frames))]


def images_are_those_of_the_library():
    pattern = numpy.random.default_rng(7).random((CELLS, CELLS, 3))
    pattern[0, :4] = [0, 1, 0.02]
    for form in ("affine", "quadratic", "affine-curve", "quadratic-curve"):
        views = views_in(form)
        for kind, most in ((torch.float64, 1e-9), (torch.float32, 0.1 / 255)):
            images = render(torch.tensor(pattern).permute(2, 0, 1).to(kind), views)
            assert images.shape == (2, 3, 64, 96) and images.dtype == kind
            for image, view in zip(images, views):
                gap = numpy.abs(image.permute(1, 2, 0).numpy() - view.render(pattern)).max()
                assert gap < most, (form, kind, gap)


def gradients_are_differences():
    cells = torch.tensor(numpy.random.default_rng(3).uniform(0.1, 0.9, (3, 4, 4)), requires_grad=True)
    views = [frames.view(index, cells=4, tile_mm=TILE_MM) for index in range(2)]
    weights = torch.tensor(numpy.random.default_rng(4).normal(size=(2, 3, 64, 96)))
    assert torch.autograd.gradcheck(lambda c: (render(c, views) * weights).sum(), cells, eps=1e-6, atol=1e-4)


def four_steps_are_those_of_the_attack():
    detector = f"exec:{sys.executable} {HERE / 'weave.py'}"
    how = f"--cells {CELLS} --tile-mm {TILE_MM} --steps {STEPS} --batch 2 --augment none --floor 0.5 --seed 1".split()
    attack = [sys.executable, "-m", "scaleproof", "attack", "run", str(FRAMES), "--detector", detector, *how, "-o", str(OUT / "attack")]
    subprocess.run(attack, check=True)
    by_attack = scaleproof.Pattern(OUT / "attack/pattern.png").colours

    first = scaleproof.Pattern.random(OUT / "first.png", cells=CELLS, seed=1).colours
    cells = torch.tensor(first / 255).permute(2, 0, 1).contiguous().requires_grad_()
    optimiser = torch.optim.Adam([cells])
    views = views_in("quadratic-curve")
    for step in range(STEPS):
        images = render(cells, views)
        by_image = [loss_and_gradient(image.permute(1, 2, 0).detach().numpy().astype(numpy.float32))[1] for image in images]
        optimiser.zero_grad()
        images.backward(torch.tensor(numpy.stack(by_image).astype(numpy.float32)).permute(0, 3, 1, 2) / 2)
        # The attack's learning rate falls along half a cosine.
        optimiser.param_groups[0]["lr"] = 0.1 * (0.55 + 0.45 * math.cos(math.pi * step / STEPS))
        optimiser.step()
        with torch.no_grad():
            cells.clamp_(0, 1)
    here = (255 * cells.detach().permute(1, 2, 0).numpy()).round()
    moved, gap = numpy.abs(here - first).max(), numpy.abs(here - by_attack).max()
    assert moved > 20 and gap <= 1, (moved, gap)
    print(f"four steps: moved by up to {moved:.0f} of 255, the attack's pattern within {gap:.0f}")


def the_example_runs():
    example = HERE.parent / "examples/attack_in_torch.py"
    ran = subprocess.run([sys.executable, example, FRAMES, OUT / "example.png", "3"], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    losses = [float(line.split(": ")[1]) for line in ran.stdout.splitlines()[:3]]
    assert losses[2] < losses[0] and scaleproof.Pattern(OUT / "example.png").colours.shape == (16, 16, 3), ran.stdout


def the_page_on_graphics_cards_runs():
    page, folder = (HOME / "docs/guide/on-a-graphics-card.md").read_text(), OUT / "page"
    folder.mkdir()
    (folder / "captures").symlink_to(HOME / "captures")
    for name, code in re.findall(r"^```python\n# (\S+)\n(.*?)^```$", page, re.DOTALL | re.MULTILINE):
        (folder / name).write_text(code)
    [command] = re.findall(r"^\./run (attack run .*)$", page, re.MULTILINE)
    words = [f"exec:{sys.executable} program.py" if "exec:" in word else word for word in shlex.split(command)]
    subprocess.run([sys.executable, "-m", "scaleproof", *words], cwd=folder, check=True)
    assert scaleproof.Pattern(folder / "out/card/attack/pattern.png").colours.shape == (8, 8, 3)
    ran = subprocess.run([sys.executable, "pattern.py"], cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    losses = [float(line.split()[1]) for line in ran.stdout.splitlines()]
    assert losses[-1] < losses[0] and scaleproof.Pattern(folder / "pattern.png").colours.shape == (8, 8, 3), ran.stdout


images_are_those_of_the_library()
gradients_are_differences()
four_steps_are_those_of_the_attack()
the_example_runs()
the_page_on_graphics_cards_runs()
