"""From RAPID's motion effects to timed trajectories: geometry, zones, timing, and the three views of the result."""
