"""A data set against its nominal model as a linear problem: targets, candidates, and what the motion can show."""
