"""The engine `equilibrium`: static steps with the multiplier as an unknown."""
