# SPDX-License-Identifier: Apache-2.0
"""Measurements that the README quotes; each has `run(out) -> dict` and writes OUT/results.json."""
