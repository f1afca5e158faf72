"""Picture files of every kind, made here: read rightly, or one clear line."""

import struct
import warnings
import zlib

import numpy as np
import pytest
from color_profiles import adobe_rgb, display_p3, inks
from PIL import Image
from refused_pictures import refused

from proxy_renderer.reference.files import read_reference

ORANGE = (230, 120, 40)


def saved(path, mode="RGB", color=ORANGE, size=(40, 30), **options):
    Image.new(mode, size, color).save(path, **options)
    return path


def halves(size=(40, 30)):
    """Red on the left, blue on the right."""
    picture = Image.new("RGB", size, (255, 0, 0))
    picture.paste((0, 0, 255), (size[0] // 2, 0, *size))
    return picture


def png(path, width, height, depth, kind, rows, *chunks):
    """A PNG of 16 bits, which Pillow does not write."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    data = b"".join(b"\0" + row for row in rows)
    parts = (
        chunk(b"IHDR", head),
        *(chunk(*c) for c in chunks),
        chunk(b"IDAT", zlib.compress(data)),
        chunk(b"IEND", b""),
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    return path


@pytest.mark.parametrize(
    ("name", "tolerance"), [("a.png", 0), ("a.jpg", 4), ("a.webp", 6), ("a.tif", 0), ("a.bmp", 0), ("a.avif", 6)]
)
def test_ordinary_files(tmp_path, name, tolerance):
    found = read_reference(saved(tmp_path / name))
    assert found.display.shape == (30, 40, 3)
    assert found.display.dtype == np.float32
    assert np.abs(found.display - np.array(ORANGE) / 255).max() <= tolerance / 255 + 1e-6
    assert found.linear is None
    assert found.alpha is None
    assert not found.panorama


def test_a_files_first_bytes_count_and_not_its_name(tmp_path):
    found = read_reference(saved(tmp_path / "still.jpg", format="PNG"))
    assert np.allclose(found.display, np.array(ORANGE) / 255)


@pytest.mark.parametrize("mode", ["1", "L", "I;16"])
def test_gray_files(tmp_path, mode):
    white = {"1": 1, "L": 255, "I;16": 65535}[mode]
    found = read_reference(saved(tmp_path / "gray.png", mode, white))
    assert np.allclose(found.display, 1.0)


def test_16_bits_are_not_cut_off_at_8(tmp_path):
    gray = saved(tmp_path / "gray.png", "I;16", 32768)
    assert read_reference(gray).display.mean() == pytest.approx(0.5, abs=0.004)
    assert read_reference(saved(tmp_path / "gray.tif", "I;16", 16384)).display.mean() == pytest.approx(0.25, abs=0.004)
    color = png(tmp_path / "color.png", 2, 1, 16, 2, [struct.pack(">6H", *(40000, 20000, 60000) * 2)])
    assert np.allclose(read_reference(color).display[0, 0], np.array((40000, 20000, 60000)) / 65535, atol=0.004)


def test_a_palette_and_its_transparent_color(tmp_path):
    flat = halves().quantize(4)
    flat.save(tmp_path / "plain.png")
    assert np.allclose(read_reference(tmp_path / "plain.png").display[0, 0], (1, 0, 0), atol=0.01)
    flat.save(tmp_path / "holes.png", transparency=flat.getpixel((0, 0)))
    found = read_reference(tmp_path / "holes.png")
    assert found.alpha[0, 0] == 0.0
    assert found.alpha[0, -1] == 1.0


def test_what_is_transparent_does_not_color_what_is_reduced(tmp_path):
    picture = Image.new("RGBA", (2048, 8), (0, 255, 0, 0))
    picture.paste((255, 0, 0, 255), (0, 0, 1023, 8))
    picture.save(tmp_path / "half.png")
    found = read_reference(tmp_path / "half.png")
    assert found.display.shape == (4, 1024, 3)
    edge = 511  # a pixel of it shows one red column and one clear one
    assert found.alpha[0, edge] == pytest.approx(0.5, abs=0.01)
    assert np.allclose(found.display[0, edge], (1, 0, 0), atol=0.01)


def test_opaque_alpha_counts_for_nothing(tmp_path):
    assert read_reference(saved(tmp_path / "a.png", "RGBA", (*ORANGE, 255))).alpha is None


@pytest.mark.parametrize(
    ("icc", "name", "red", "green"),
    # Known values: the Bradford-adapted matrices of these spaces, and gamma 2.2, by hand.
    [
        (display_p3(), "Display P3", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        (adobe_rgb(), "Adobe RGB", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ],
)
def test_wide_colors_are_brought_to_srgb(tmp_path, icc, name, red, green):
    inside = (150, 110, 90)
    found = read_reference(saved(tmp_path / "wide.jpg", color=inside, icc_profile=icc, quality=100, subsampling=0))
    linear = (np.array(inside) / 255) ** 2.2
    matrices = {
        "Display P3": ((1.2249, -0.2247, 0.0), (-0.0420, 1.0419, 0.0), (-0.0197, -0.0786, 1.0979)),
        "Adobe RGB": ((1.3983, -0.3983, 0.0), (0.0, 1.0, 0.0), (0.0, -0.0429, 1.0429)),
    }
    expected = (matrices[name] @ linear) ** (1 / 2.2)
    assert np.abs(found.display[0, 0] - expected).max() < 0.015
    assert found.display[0, 0, 0] > inside[0] / 255 + 0.01
    pure = read_reference(saved(tmp_path / "red.png", color=(255, 0, 0), icc_profile=icc)).display[0, 0]
    assert np.allclose(pure, red, atol=0.02)
    assert np.allclose(
        read_reference(saved(tmp_path / "green.png", color=(0, 255, 0), icc_profile=icc)).display[0, 0],
        green,
        atol=0.02,
    )


def test_a_profile_with_alpha(tmp_path):
    found = read_reference(saved(tmp_path / "a.png", "RGBA", (150, 110, 90, 128), icc_profile=display_p3()))
    assert found.alpha.mean() == pytest.approx(0.5, abs=0.01)
    assert found.display[0, 0, 0] > 150 / 255 + 0.01


def test_a_broken_profile_is_taken_for_srgb(tmp_path):
    found = read_reference(saved(tmp_path / "a.png", icc_profile=b"no profile"))
    assert np.allclose(found.display, np.array(ORANGE) / 255)


def test_inks_with_and_without_a_profile(tmp_path):
    plain = read_reference(saved(tmp_path / "inks.jpg", "CMYK", (0, 255, 255, 0), quality=100))
    assert np.allclose(plain.display[0, 0], (1, 0, 0), atol=0.02)
    found = read_reference(saved(tmp_path / "inks.tif", "CMYK", (0, 255, 255, 0), icc_profile=inks()))
    assert np.ptp(found.display[0, 0]) < 0.02  # half of all ink: L 50, a middle gray
    assert found.display[0, 0, 0] == pytest.approx(0.466, abs=0.02)


def test_what_is_transparent_in_an_animation_does_not_count(tmp_path):
    frames = [Image.new("RGBA", (20, 20), (0, 255, 0, 0)) for _ in range(2)]
    frames[0].paste((255, 0, 0, 255), (10, 0, 20, 20))
    for name in ("a.gif", "a.webp"):
        frames[0].save(tmp_path / name, save_all=True, append_images=frames[1:], lossless=True)
        found = read_reference(tmp_path / name)
        assert (found.alpha[:, :10] == 0.0).all()
        assert (found.alpha[:, 10:] == 1.0).all()
        assert np.allclose(found.display[10, 15], (1, 0, 0), atol=0.01)


def test_16_bits_with_a_profile_and_alpha(tmp_path):
    pixel = struct.pack(">4H", 150 * 257, 110 * 257, 90 * 257, 32768)
    profile = b"P3\0\0" + zlib.compress(display_p3())
    found = read_reference(png(tmp_path / "a.png", 2, 1, 16, 6, [pixel * 2], (b"iCCP", profile)))
    assert found.display[0, 0, 0] > 150 / 255 + 0.01
    assert found.alpha[0, 0] == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("name", ["a.gif", "a.webp", "a.png"])
def test_of_animations_the_first_frame(tmp_path, name):
    frames = [Image.new("RGB", (20, 20), color) for color in ((255, 0, 0), (0, 255, 0), (0, 0, 255))]
    frames[0].save(tmp_path / name, save_all=True, append_images=frames[1:])
    found = read_reference(tmp_path / name)
    assert np.allclose(found.display[10, 10], (1, 0, 0), atol=0.03)


@pytest.mark.parametrize("name", ["phone.jpg", "phone.png", "phone.webp", "phone.tif"])
def test_exif_turns_it_upright(tmp_path, name):
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera was turned: left becomes top
    halves().save(tmp_path / name, exif=exif, quality=95)
    found = read_reference(tmp_path / name)
    assert found.display.shape == (40, 30, 3)
    assert found.display[2, 15, 0] > 0.9
    assert found.display[-3, 15, 2] > 0.9


@pytest.mark.parametrize("name", ["large.jpg", pytest.param("large.png", marks=pytest.mark.slow)])
def test_a_hundred_megapixels(tmp_path, name):
    halves((12500, 8000)).save(tmp_path / name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = read_reference(tmp_path / name)
    assert found.display.shape[:2] == (655, 1024)
    assert found.display[300, 100, 0] > 0.97


def test_a_bomb_is_refused(tmp_path):
    rows = ((b"\0" * 2500) for _ in range(20000))
    refused(png(tmp_path / "bomb.png", 20000, 20000, 1, 0, rows), "megapixels", "Scale it down")


def test_all_transparent_is_refused(tmp_path):
    refused(saved(tmp_path / "a.png", "RGBA", (9, 9, 9, 0)), "transparent")


def test_files_that_are_no_pictures(tmp_path):
    text = tmp_path / "text.jpg"
    text.write_text("This is a text, and no picture.")
    refused(text, "text.jpg", "not a picture", "PNG")
    refused(tmp_path, "folder")
    refused(tmp_path / "missing.png", "no picture", "Check the path")
    (tmp_path / "empty.png").touch()
    refused(tmp_path / "empty.png", "is empty")
    refused(png(tmp_path / "zero.png", 0, 4, 8, 2, [b""] * 4), "zero.png")


@pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.webp", "a.tif", "a.gif"])
def test_truncated_files(tmp_path, name):
    noise = np.random.default_rng(0).integers(0, 255, (200, 200, 3), np.uint8)
    Image.fromarray(noise).save(tmp_path / name)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: len(whole) // 2])
    refused(tmp_path / name, name)


def test_pictures_of_phones_and_cameras_are_told_what_to_become(tmp_path):
    (tmp_path / "phone.heic").write_bytes(b"\0\0\0\x18ftypheic\0\0\0\0mif1heic")
    refused(tmp_path / "phone.heic", "phone.heic is not a picture", "JPEG")
    saved(tmp_path / "camera.nef", format="TIFF")  # such a file is a TIFF with a thumbnail in it
    refused(tmp_path / "camera.nef", "raw", "Develop")


def test_every_direction_is_told_by_the_seam(tmp_path):
    x = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    y = np.linspace(-1, 1, 200)[:, None]
    around = 0.5 + 0.4 * np.sin(x) * (1 - y**2) + 0.1 * y
    sky = (255 * np.repeat(around[..., None], 3, -1)).astype(np.uint8)
    Image.fromarray(sky).save(tmp_path / "sky.png")
    assert read_reference(tmp_path / "sky.png").panorama
    half = (255 * np.repeat((0.5 + 0.4 * np.sin(x / 2) + 0 * y)[..., None], 3, -1)).astype(np.uint8)
    Image.fromarray(half).save(tmp_path / "wide.png")
    assert not read_reference(tmp_path / "wide.png").panorama
