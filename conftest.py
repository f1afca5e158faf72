# SPDX-License-Identifier: Apache-2.0
"""For all tests: no language model of the reader's is asked, and parallel workers share the cores."""

import os

from jaxtyping import install_import_hook

os.environ.pop("VIBE_VLM_MODEL", None)
if workers := int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", 0)):  # before torch is imported, and for the engines
    os.environ.setdefault("OMP_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // workers)))
# Shapes of what has jaxtyping's annotations are checked in tests, not in the product.
install_import_hook(
    [
        "proxy_renderer.color.tensors",
        "proxy_renderer.color.view_transform",
        "proxy_renderer.render.film",
        "proxy_renderer.render.geometry.camera",
        "proxy_renderer.render.lights.area_specular",
        "proxy_renderer.render.lights.light_types",
        "proxy_renderer.render.material.albedo",
        "proxy_renderer.render.surface.principled",
        "proxy_renderer.render.transport.fog",
        "proxy_renderer.render.transport.secondary_hits",
    ],
    "beartype.beartype",
)
