# SPDX-License-Identifier: Apache-2.0
"""A vision-language model as parser, confiner and judge, behind any OpenAI-compatible endpoint; imported only if one is named."""
