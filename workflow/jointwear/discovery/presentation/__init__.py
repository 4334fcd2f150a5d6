"""The page and the chapter of one data set, and their figures."""
