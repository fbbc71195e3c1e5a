"""The virtual controller: the simulated controller behind ABB's Robot Web Services 1.0, 2.0 and those of RobotWare 8.

`service.Service` answers calls without any I/O; `server` is its HTTP and WebSocket shell. What is asked for and answered follows
`facts/rws.md` of the project, which names the clients that rely on each detail.
"""
