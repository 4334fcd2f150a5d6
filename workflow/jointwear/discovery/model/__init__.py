"""From the effects that were found to robot files that predict no joint worse than the given one."""
