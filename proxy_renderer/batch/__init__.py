# SPDX-License-Identifier: Apache-2.0
"""Many scenes, many prompts, many machines: `vibe batch`.

`manifest` reads what is to be done, `plan` turns it into jobs, `store` is the results folder, `worker` is a warm Blender
that carries out jobs, `schedule` hands them to workers on this machine, `cluster` to those of others, `sheet` shows the results.
"""
