# SPDX-License-Identifier: Apache-2.0
"""The commands, a file each: `SUMMARY`, `add_options(parser)` and `act(arguments)`, which returns the exit code."""
