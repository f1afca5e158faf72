# SPDX-License-Identifier: Apache-2.0
"""Algorithm 1: parse, compose, confine, select, project, inner steps, stabilize."""
