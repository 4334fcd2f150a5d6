"""The page of the hidden-effect test, with the tier "world" beside the others, and the summary that is kept of it."""
