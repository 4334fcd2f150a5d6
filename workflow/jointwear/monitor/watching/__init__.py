"""Every quantity against its normal state: shared errors, decisions, alarms, growth and forecasts."""
