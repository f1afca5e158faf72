# SPDX-License-Identifier: Apache-2.0
"""From radiance to the picture that an artist sees."""
