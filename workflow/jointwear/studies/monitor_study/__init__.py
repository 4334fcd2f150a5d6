"""Study of the monitor on the paper's grid: detection, location, forecast, peers, and factory confounders."""
