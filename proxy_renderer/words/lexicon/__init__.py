# SPDX-License-Identifier: Apache-2.0
"""The words that are known: data files, and the modules that read them."""
