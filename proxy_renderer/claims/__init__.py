# SPDX-License-Identifier: Apache-2.0
"""Claims: intervals of measures that make words visible in an image, and verdicts on images by these intervals."""
