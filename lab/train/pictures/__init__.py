# SPDX-License-Identifier: Apache-2.0
"""Training pictures: shapes, looks, shaders, and what each picture shows."""
