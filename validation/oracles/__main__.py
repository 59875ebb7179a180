"""Rewrite validation/reference/end_states.csv (about six minutes)."""

from validation.oracles.end_states import rewrite

rewrite()
