"""A free crank under measured pressures, held against the speed that the machine's wheel showed."""
