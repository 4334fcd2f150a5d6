"""Which effects a data set shows: gates, search, structure that is left, probability of a name."""
