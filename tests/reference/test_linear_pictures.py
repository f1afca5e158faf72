"""OpenEXR and Radiance pictures, made here."""

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from refused_pictures import refused

from proxy_renderer.color.arrays import srgb_from_linear
from proxy_renderer.reference.files import read_reference, rec709_from

COLOR = (0.5, 0.25, 2.0)


def exr(path, channels, **header):
    given = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage} | header
    with OpenEXR.File(given, channels) as file:
        file.write(str(path))
    return path


def flat(color=COLOR, size=(6, 8), kind=np.float32):
    return np.full((*size, len(color)), color, kind)


@pytest.mark.parametrize("kind", [np.float16, np.float32])
def test_an_exr_is_linear_light(tmp_path, kind):
    found = read_reference(exr(tmp_path / "a.exr", {"RGB": flat(kind=kind)}))
    assert np.allclose(found.linear, COLOR, rtol=1e-3)
    assert np.allclose(found.display[0, 0], srgb_from_linear(np.array(COLOR)).clip(0, 1), atol=1e-3)
    assert found.alpha is None


def test_of_many_layers_the_combined_one(tmp_path):
    layers = {
        "ViewLayer.Combined": flat((*COLOR, 1.0)),
        "ViewLayer.DiffCol": flat((1.0, 0.0, 0.0)),
        "ViewLayer.Depth.Z": np.full((6, 8), 7.0, np.float32),
    }
    found = read_reference(exr(tmp_path / "a.exr", layers))
    assert np.allclose(found.linear, COLOR, rtol=1e-3)


def test_of_many_parts_the_combined_one(tmp_path):
    """As Blender 5 writes them."""
    parts = [
        OpenEXR.Part({"name": name}, {f"ViewLayer.{name}": flat(color)})
        for name, color in (("Normal", (0.0, 0.0, 1.0)), ("Combined", COLOR))
    ]
    with OpenEXR.File(parts) as file:
        file.write(str(tmp_path / "a.exr"))
    assert np.allclose(read_reference(tmp_path / "a.exr").linear, COLOR, rtol=1e-3)


def test_colors_times_alpha_are_divided_again(tmp_path):
    pixels = flat((0.2, 0.1, 0.05, 0.5))
    pixels[:, 4:] = 0.0
    found = read_reference(exr(tmp_path / "a.exr", {"RGBA": pixels}))
    assert np.allclose(found.linear[:, :4], (0.4, 0.2, 0.1), atol=1e-3)
    assert np.allclose(found.alpha[:, :4], 0.5, atol=1e-3)
    assert (found.alpha[:, 4:] == 0).all()


def test_pixels_that_are_no_numbers_do_not_count(tmp_path):
    pixels = flat(size=(4, 2048))
    pixels[:, 0] = np.nan
    pixels[:, 1, 2] = np.inf
    pixels[:, 3] = -5.0
    found = read_reference(exr(tmp_path / "a.exr", {"RGB": pixels}))
    assert found.linear.shape == (2, 1024, 3)
    assert np.isfinite(found.linear).all()
    assert (found.linear >= 0).all()
    assert (found.alpha[:, 0] == 0).all()
    nothing = exr(tmp_path / "none.exr", {"RGB": np.full((4, 4, 3), np.nan, np.float32)})
    refused(nothing, "none.exr")


def test_gray_and_no_colors_at_all(tmp_path):
    gray = read_reference(exr(tmp_path / "a.exr", {"Y": np.full((6, 8), 0.25, np.float32)}))
    assert np.allclose(gray.linear, 0.25)
    depth = exr(tmp_path / "depth.exr", {"Depth.Z": np.full((6, 8), 0.25, np.float32)})
    refused(depth, "no layer with colors", "Combined")


def test_other_primaries_become_rec709(tmp_path):
    aces = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    known = ((1.70505, -0.62179, -0.08326), (-0.13026, 1.14080, -0.01055), (-0.02400, -0.12897, 1.15297))
    assert np.allclose(rec709_from(aces), known, atol=2e-3)
    found = read_reference(exr(tmp_path / "a.exr", {"RGB": flat((0.3, 0.4, 0.5))}, chromaticities=aces))
    assert np.allclose(found.linear[0, 0], np.array(known) @ (0.3, 0.4, 0.5), atol=2e-3)


def test_damaged_exrs(tmp_path):
    whole = exr(tmp_path / "a.exr", {"RGB": np.random.default_rng(0).random((64, 64, 3), np.float32)}).read_bytes()
    for length in (8, 200, len(whole) // 2):
        (tmp_path / "cut.exr").write_bytes(whole[:length])
        refused(tmp_path / "cut.exr", "cut.exr")


def test_a_tiff_of_floating_point_numbers_is_linear(tmp_path):
    Image.fromarray(np.full((6, 8), 0.25, np.float32)).save(tmp_path / "a.tif")
    assert np.allclose(read_reference(tmp_path / "a.tif").linear, 0.25)


def rgbe(color):
    """Four bytes, as Ward's paper has it."""
    fraction, exponent = np.frexp(max(color))
    return bytes((*(int(v * fraction * 256 / max(color)) for v in color), int(exponent) + 128))


def hdr(path, body, width=8, height=2, head=b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"):
    path.write_bytes(head + f"-Y {height} +X {width}\n".encode() + body)
    return path


def test_radiance_plain_and_in_runs(tmp_path):
    pixel = rgbe(COLOR)
    plain = read_reference(hdr(tmp_path / "plain.hdr", pixel * 16))
    assert np.allclose(plain.linear, COLOR, atol=1 / 128)  # half a step of the mantissa
    line = b"\x02\x02\x00\x08" + bytes(v for byte in pixel for v in (128 + 5, byte, 3, byte, byte, byte))
    runs = read_reference(hdr(tmp_path / "runs.hdr", line * 2))
    assert (runs.linear == plain.linear).all()
    black = read_reference(hdr(tmp_path / "black.hdr", bytes(4 * 16)))
    assert (black.linear == 0).all()


@pytest.mark.parametrize(
    "body",
    [b"", rgbe(COLOR) * 15, b"\x02\x02\x00\x08\x85", b"\x02\x02\x00\x08" + b"\xff\x01" * 9, b"\x02\x02\x00\x08\x00"],
)
def test_damaged_radiance(tmp_path, body):
    refused(hdr(tmp_path / "a.hdr", body), "a.hdr")


def test_odd_radiance(tmp_path):
    refused(hdr(tmp_path / "xyz.hdr", rgbe(COLOR) * 16, head=b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n"), "EXR")
    refused(hdr(tmp_path / "large.hdr", b"", width=10**6, height=10**6), "large.hdr")
