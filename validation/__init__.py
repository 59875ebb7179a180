"""What the project claims, checked against sources and against independent oracles."""
