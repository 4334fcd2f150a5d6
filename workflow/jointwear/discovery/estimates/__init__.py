"""What an effect gains a fit, its refined parameters, and its size with an interval."""
