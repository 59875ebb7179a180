"""Physical mutants of crankmbs: one law of the mechanics broken at a time, and what turns red."""
