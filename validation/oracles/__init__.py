"""Independent references of high precision; nothing here imports crankmbs."""
