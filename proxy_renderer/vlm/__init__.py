# SPDX-License-Identifier: Apache-2.0
"""A vision-language model as parser, confiner and judge, behind any OpenAI-compatible endpoint; optional.

    endpoint    which model, where, and whose key: options, then the environment
    transport   one request through the `openai` package, bounded in time and size, and what is read in its answer
    client      asks: retries, time limits, cache, what the server cannot do, what it costs
    request     the question and the JSON schema of its answer, under names that hold no text of the artist's
    reply       the answer, checked field by field
    advisor     the rounds' advice: the model's where it answers, the offline planner's where it does not
    judge       the paper's evaluation

Nothing here is imported unless a model is named, `openai` not before the first question.
"""
