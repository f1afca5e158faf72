# SPDX-License-Identifier: Apache-2.0
"""A vision-language model that reads prompts, plans ranges and judges images; imported only if one is named."""
