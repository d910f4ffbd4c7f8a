"""Gas, valves, sensors: from valve commands to the gauge pressure in every finger."""
