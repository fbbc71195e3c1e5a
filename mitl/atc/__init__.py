"""The automated test cases: one Python file a topic, its RAPID beside it. `pytest --pyargs mitl.atc` runs them."""
