# SPDX-License-Identifier: Apache-2.0
"""The tutorial's pictures, small, from what its commands have written.

python docs/tutorial/pictures.py [FOLDER]     FOLDER is the commands' `out`
"""

import sys
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
PICTURES = {
    "before.jpg": ("teal/before.png", 480),
    "teal.jpg": ("teal/compare.png", 1000),
    "noir.jpg": ("noir/after.png", 480),
    "mist.jpg": ("mist/compare.png", 1000),
    "looks.jpg": ("looks/variants.png", 1000),
}
"""Picture of the tutorial: the file that it is made of, and its width in pixels."""


def main(folder: Path) -> None:
    """Writes them beside this file."""
    for name, (source, width) in PICTURES.items():
        picture = Image.open(folder / source).convert("RGB")
        picture.thumbnail((width, width), Image.Resampling.LANCZOS)
        picture.save(HERE / name, quality=85, optimize=True)
        print(f"{HERE / name}: {(HERE / name).stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
