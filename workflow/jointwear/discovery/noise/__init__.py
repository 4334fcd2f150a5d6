"""The noise of torques and positions: its colour, its spectrum, and what of it moves the arm."""
