"""Answers the open questions of the thesis from studies in studies/open-questions: `scripts/open-questions`.

A question is a module with the names of its `STUDIES`, `values`, which returns tables and numbers for
docs/records/open-questions.json, and `figure`, which draws its figure.
"""
