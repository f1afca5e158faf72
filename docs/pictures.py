# SPDX-License-Identifier: Apache-2.0
"""The documents' images, small, and figures, from what commands have written into one folder; missing ones are skipped.

python docs/pictures.py [FOLDER]     FOLDER is the commands' `out`

demo.jpg       vibe demo --out out/demo
dolphin.jpg    vibe run dolphin.obj --prompt "Glossy teal dolphin, white studio background." --out out/dolphin
tree.jpg       vibe run tree.obj --prompt "Misty tree silhouette, cool blue fog, vignette." --out out/tree
like.jpg       vibe demo --like coffee.png --out out/like, coffee.png being skimage.data.coffee()
fidelity.jpg   python -m lab fidelity --out out/fidelity
sealed.jpg     python -m lab sealed --out out/sealed
gallery/       vibe batch examples/batch.toml --out out/gallery, after the scenes (examples/README.md)
rigs.jpg       vibe batch examples/rigs.toml --out out/rigs
results/       results.json of out/sealed, and of out/sealed-long (`python -m lab sealed --long --out out/sealed-long`)
tutorial/      the tutorial's own commands
panel.jpg, progress.jpg, presets.jpg, first-look.webp
               screenshots of the window test (needs a Blender with a window):
               VIBE_WINDOW_OUT=out/window python -m pytest -m slow blender_tests/ui/test_window*.py
light-mix.jpg  the same with -k light_is_mixed
"""

import json
import shutil
import sys
import tomllib
from pathlib import Path

from PIL import Image, ImageOps

HERE = Path(__file__).parent
PICTURES = {
    "demo.jpg": ("demo/compare.png", 1200),
    "dolphin.jpg": ("dolphin/compare.png", 1200),
    "tree.jpg": ("tree/compare.png", 1200),
    "like.jpg": ("like/compare.png", 1200),
    "sealed.jpg": ("sealed/contact.png", 1200),
    "tutorial/before.jpg": ("teal/before.png", 480),
    "tutorial/teal.jpg": ("teal/compare.png", 1000),
    "tutorial/noir.jpg": ("noir/after.png", 480),
    "tutorial/mist.jpg": ("mist/compare.png", 1000),
    "tutorial/looks.jpg": ("looks/variants.png", 1000),
}
"""Picture of the documents: the file that it is made of, and its width in pixels."""

RESULTS = ("sealed", "sealed-long")
"""Benchmarks whose figures are kept."""

SCENES = (
    "copper_rings",
    "frosted_bottle",
    "globe",
    "stage_spots",
    "columns_haze",
    "granite_knot",
    "cornell_box",
    "worn_car",
)
"""Scenes of fidelity.jpg, from left to right."""

RIGS = tuple(tomllib.loads((HERE.parent / "examples" / "rigs.toml").read_text("utf-8"))["prompts"])
"""Prompts of rigs.jpg, from left to right."""

GALLERY = {
    "interior": "cozy evening by lamplight, warm",
    "interior-2": "golden hour, sun through the window, cozy",
    "interior-3": "moonlight through the window, quiet blue night",
    "landscape": "sunset, warm orange sky, thin mist over the lake",
    "bust": "cinematic teal and orange, dramatic light from the left, dark background",
    "car": "glossy burgundy car, warm sunset light, long shadows",
    "street": "rainy night, neon pink and cyan light",
    "street-2": "pre-dawn, cold blue haze over the wet street",
}
"""Image of the gallery -> its prompt; a scene with several has a number behind its name."""

FAILURES = {
    "product-failed": "emerald perfume, dark moody studio, warm rim light",
    "bust-failed": "smoke around the bust, noir",
}
"""The same of results that are not worth keeping."""

PANEL = {"marks": (904, 160, 1420, 712), "result": (904, 160, 1420, 1630), "changes": (904, 160, 1420, 1630)}
"""Screenshots of panel.jpg, from left to right, and what is cut out of each: left, top, right, bottom."""

PROGRESS = (0, 25, 1185, 815)
"""What is cut out of the screenshot of progress.jpg, at the usual scale."""

GRID = (405, 60, 1195, 1020)
"""What is cut out of the screenshot of presets.jpg."""

COLUMN = (904, 160, 1420, 1333)
"""What is cut out of the screenshots of first-look.webp: the panel down to the result."""

_FRAME, _LAST, _DARK = 1500, 4500, "#1d1d1d"  # milliseconds of an animation's frames, and of its last one
LIGHT_MIX = (699, 308, 957, 722)
"""What is cut out of the screenshot of light-mix.jpg, at the usual scale."""

_SIDE, _GAP = 128, 6


def main(folder: Path) -> None:
    """Writes them beside this file."""
    for name, (source, width) in PICTURES.items():
        if (folder / source).is_file():
            picture = Image.open(folder / source).convert("RGB")
            picture.thumbnail((width, width), Image.Resampling.LANCZOS)
            save(picture, name)
    for name in RESULTS:
        if (folder / name / "results.json").is_file():
            (HERE / "results").mkdir(exist_ok=True)
            shutil.copy(folder / name / "results.json", HERE / "results" / f"{name}.json")
    if (folder / "gallery").is_dir():
        gallery(folder / "gallery" / "jobs")
    if (folder / "rigs").is_dir():
        save(rigs(folder / "rigs" / "jobs"), "rigs.jpg")
    if (folder / "window" / "tour_double").is_dir():
        panel(folder / "window")
    for shot in (folder / "window" / "light_mix").glob("*_color.png"):
        save(Image.open(shot).convert("RGB").crop(LIGHT_MIX), "light-mix.jpg")
    scenes = [folder / "fidelity" / "scenes" / name for name in SCENES]
    if all(scene.is_dir() for scene in scenes):
        save(beside(scenes), "fidelity.jpg")


def panel(shots: Path) -> None:
    """The panel in columns, and a vibe that runs."""

    def cut(shot: str, box: tuple[int, ...], scale: float) -> Image.Image:
        part = Image.open(next(shots.glob(shot))).convert("RGB").crop(box)
        return part.resize([round(side * scale) for side in part.size], Image.Resampling.LANCZOS)

    columns = [cut(f"tour_double/*_{name}.png", box, 0.7) for name, box in PANEL.items()]
    width, height = sum(c.width + _GAP for c in columns) - _GAP, max(c.height for c in columns)
    sheet, left = Image.new("RGB", (width, height), "white"), 0
    for column in columns:
        sheet.paste(column, (left, 0))
        left += column.width + _GAP
    save(sheet, "panel.jpg")
    save(cut("tour/*_running.png", PROGRESS, 0.75), "progress.jpg")
    save(cut("presets/*_grid.png", GRID, 1.0), "presets.jpg")
    first_look(shots / "tour_double")


def first_look(shots: Path) -> None:
    """A vibe from the words to the result, as an animation: the panel, and the scene before and after."""
    stages = [("marks", "bust-before"), ("running", "bust-before"), ("search", "bust-before"), ("result", "bust")]
    frames = []
    for name, render in stages:
        if not (found := sorted(shots.glob(f"*_{name}.png"))):
            continue
        frame = Image.new("RGB", (1040, 600), _DARK)
        panel = Image.open(found[-1]).convert("RGB").crop(COLUMN)
        frame.paste(panel.resize((264, 600), Image.Resampling.LANCZOS), (0, 0))
        frame.paste(Image.open(HERE / "gallery" / f"{render}.jpg").resize((768, 432)), (268, 84))
        frames.append(frame)
    times = [_FRAME] * (len(frames) - 1) + [_LAST]
    out = HERE / "first-look.webp"
    frames[0].save(out, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=80, method=6)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


def rigs(jobs: Path) -> Image.Image:
    """A row for each scene: the picture before, and one after each of `RIGS`."""
    rows: dict[str, dict[str, Path]] = {}
    for report in sorted(jobs.glob("*/report.json")):
        told = json.loads(report.read_text("utf-8"))
        rows.setdefault(told["scene"], {})[told["prompt"]] = report.parent
    width, height = 150, 100
    size = ((len(RIGS) + 1) * (width + _GAP), len(rows) * (height + _GAP))
    sheet = Image.new("RGB", size, "white")
    for row, found in enumerate(rows.values()):
        files = [found[RIGS[0]] / "before.png", *(found[prompt] / "after.png" for prompt in RIGS)]
        for column, file in enumerate(files):
            picture = ImageOps.fit(Image.open(file).convert("RGB"), (width, height), Image.Resampling.LANCZOS)
            sheet.paste(picture, (column * (width + _GAP), row * (height + _GAP)))
    return sheet


def gallery(jobs: Path) -> None:
    """An image of each scene before, and one for each of its prompts in the gallery."""
    for report in sorted(jobs.glob("*/report.json")):
        told = json.loads(report.read_text("utf-8"))
        scene = Path(told["scene"]).stem
        for name, prompt in (GALLERY | FAILURES).items():
            if name.partition("-")[0] == scene and prompt == told["prompt"]:
                for source, kept in (("before", f"{scene}-before"), ("after", name)):
                    picture = Image.open(report.parent / f"{source}.png").convert("RGB")
                    picture.thumbnail((720, 720), Image.Resampling.LANCZOS)
                    save(picture, f"gallery/{kept}.jpg")


def beside(scenes: list[Path]) -> Image.Image:
    """A column for each scene: Cycles' picture, and the proxy's below it."""
    step = _SIDE + _GAP
    sheet = Image.new("RGB", (len(scenes) * step - _GAP, 2 * step - _GAP), "white")
    for column, scene in enumerate(scenes):
        for row, name in enumerate(("cycles.png", "proxy.png")):
            picture = Image.open(scene / name).convert("RGB").resize((_SIDE, _SIDE), Image.Resampling.LANCZOS)
            sheet.paste(picture, (column * step, row * step))
    return sheet


def save(picture: Image.Image, name: str) -> None:
    """Writes a picture of the documents, and says how large it is."""
    (HERE / name).parent.mkdir(exist_ok=True)
    picture.save(HERE / name, quality=85, optimize=True)
    print(f"{HERE / name}: {(HERE / name).stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
