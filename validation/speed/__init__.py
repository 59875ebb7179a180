"""Speed against error beside other tools: what users write today, a limit in C, the kernel alone.

`python -m validation.speed SCENE` runs them. How a formulation is measured by itself belongs in
`crankmbs.work_precision`.
"""
