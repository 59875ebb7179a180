"""What moves: the plan of a run's samples, the formulations that carry the motion from start to
end, and the result's variables with their errors.

Formulations never import one another; `free` alone knows two of them.
"""
