# SPDX-License-Identifier: Apache-2.0
"""A vision-language model as parser, confiner and judge, behind any OpenAI-compatible endpoint; optional.

Nothing here is imported unless a model is named. `openai` is imported at the first question.
"""
