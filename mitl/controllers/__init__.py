"""Controllers: implementations of `protocols.Controller`, one a file, and the faults of the simulated one."""
