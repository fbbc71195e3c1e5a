"""The predefined routines, one module a family; `catalogue` finds them by name."""
