"""Statistics: intervals for what was counted or measured, and one stream of random numbers per replicate."""
