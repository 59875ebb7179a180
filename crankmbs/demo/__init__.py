"""The page of a scene: the mechanism moving, and what each of its knobs changes."""
