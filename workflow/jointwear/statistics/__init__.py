"""Statistics: intervals for what was counted or measured, medians of what is known, runs of equal values, series
beyond their ends, and one stream of random numbers per replicate."""
