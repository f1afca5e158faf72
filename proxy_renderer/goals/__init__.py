# SPDX-License-Identifier: Apache-2.0
"""Goals for the image: the wishes of the words, and the rules that decide which wish wins a conflict."""
