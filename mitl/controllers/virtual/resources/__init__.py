"""The resources of the virtual controller, a room a file; each gives its lines of the table of routes."""
