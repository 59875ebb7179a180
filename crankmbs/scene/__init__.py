"""What a user writes: a scene as frozen dataclasses that check themselves, read from TOML and
written back, with units, tables and the sentences of refusals.

Nothing here computes a motion or a force.
"""
