# SPDX-License-Identifier: Apache-2.0
"""Prompts and scenes that nobody can tune to: drawn from the hash of the judged commit, and judged by their pictures."""

from lab.bench.sealed.experiment import run as run
