"""jointwear: wear in the joints of industrial robots, simulated, detected, located and explained."""

__version__ = "0.1.0"
