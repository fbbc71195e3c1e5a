"""The client of ABB's Robot Web Services: a real controller, IRC5 (1.0), OmniCore (2.0) or RobotWare 8, as a Controller.

`dialects` and `answers` are without I/O: what is sent and how an answer is read. `transport` paces, repeats and authenticates;
`controller` is the Controller; `events` listens to subscriptions.
"""
