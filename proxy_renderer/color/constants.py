# SPDX-License-Identifier: Apache-2.0
"""The constants of sRGB, Rec.709, CIE Lab and OKLab, each written once, for all modules. Standard library only."""

Lab = tuple[float, float, float]  # CIE L*a*b* under D65 with L in [0, 100], or OKLab with L in [0, 1]
ColorMatrix = tuple[Lab, Lab, Lab]  # three rows

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)  # luminance of the linear Rec.709 primaries

# The sRGB curve (IEC 61966-2-1): a line near black, a power above.
SRGB_SLOPE = 12.92
SRGB_LINEAR_END, SRGB_ENCODED_END = 0.0031308, 0.04045  # end of the line, in linear light and encoded
SRGB_SCALE, SRGB_OFFSET, SRGB_EXPONENT = 1.055, 0.055, 2.4

XYZ_FROM_REC709: ColorMatrix = (
    (0.4124564, 0.3575761, 0.1804375),
    (0.2126729, 0.7151522, 0.0721750),
    (0.0193339, 0.1191920, 0.9503041),
)
REC709_FROM_XYZ: ColorMatrix = (
    (3.2404542, -1.5371385, -0.4985314),
    (-0.9692660, 1.8760108, 0.0415560),
    (0.0556434, -0.2040259, 1.0572252),
)
WHITE: Lab = (0.95047, 1.0, 1.08883)  # XYZ of D65

# The curve of CIE Lab: a line near black, a cube root above.
LAB_DELTA = 6 / 29  # value of the curve where the line ends, which is at XYZ / white = LAB_DELTA³
LAB_RISE, LAB_RUN = 841, 108
"""The line's slope 1 / (3 LAB_DELTA²) as a fraction. Multiply by the rise first: rounding depends on the order."""
LAB_OFFSET = 4 / 29

CONES_FROM_REC709: ColorMatrix = (
    (0.4122215, 0.5363325, 0.0514460),
    (0.2119035, 0.6806995, 0.1073970),
    (0.0883025, 0.2817188, 0.6299787),
)
REC709_FROM_CONES: ColorMatrix = (
    (4.0767417, -3.3077116, 0.2309699),
    (-1.2684380, 2.6097574, -0.3413194),
    (-0.0041961, -0.7034186, 1.7076147),
)
OKLAB_FROM_CONES: ColorMatrix = (
    (0.2104543, 0.7936178, -0.0040720),
    (1.9779985, -2.4285922, 0.4505937),
    (0.0259040, 0.7827718, -0.8086758),
)
"""Takes the cube roots of the cone responses, which `CONES_FROM_OKLAB` returns."""
CONES_FROM_OKLAB: ColorMatrix = (
    (1.0, 0.3963378, 0.2158038),
    (1.0, -0.1055613, -0.0638542),
    (1.0, -0.0894842, -1.2914855),
)
