# SPDX-License-Identifier: Apache-2.0
"""What the image must look like: wishes, and which one wins a conflict."""
