"""The health check of robot and tracker (`mitl health`): test cases of their own, judged by limits and by a stored baseline."""
