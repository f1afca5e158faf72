# SPDX-License-Identifier: Apache-2.0
"""The gallery's prompts are those of the manifest that makes its images, and the images are small."""

import runpy
import tomllib
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
MADE = runpy.run_path(str(ROOT / "docs" / "pictures.py"))


def test_the_manifest_and_the_scripts_have_the_gallery_s_prompts():
    tables = tomllib.loads((ROOT / "examples" / "batch.toml").read_text("utf-8"))["scene"]
    page = (ROOT / "docs" / "start" / "gallery.md").read_text("utf-8")
    for prompts in (MADE["GALLERY"], MADE["FAILURES"]):
        for name, prompt in prompts.items():
            scene = name.partition("-")[0]
            assert (ROOT / "examples" / f"{scene}.py").is_file()
            assert prompt in tables[f"*{scene}*"]["prompts"]
            if f"gallery/{name}.jpg" in page:
                assert f"`{prompt}`" in page


def test_images_are_720_wide_and_below_120_kilobytes():
    images = sorted((ROOT / "docs" / "gallery").glob("*.jpg"))
    assert 8 <= len(images) <= 16
    assert {Image.open(image).width for image in images} == {720}
    assert max(image.stat().st_size for image in images) < 120_000
