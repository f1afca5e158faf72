# SPDX-License-Identifier: Apache-2.0
"""Which of a scene's lights the words mean, and which lights it lacks."""
