# SPDX-License-Identifier: Apache-2.0
"""Many scenes, many prompts, many machines: `vibe batch`.

`manifest` reads what is wanted, `plan` turns it into jobs, `store` is the results folder, `worker` is a warm Blender
that carries out jobs, `local` and `cluster` are many of those, `schedule` hands the jobs out, `sheet` shows the results.
"""
