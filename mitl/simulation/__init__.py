"""The simulated cell: a Drake diagram of arm and tracker, in virtual time. Nothing is imported here, so that Drake loads only when used."""
