"""Running: the task that steps through compiled code, and the values it works on."""
