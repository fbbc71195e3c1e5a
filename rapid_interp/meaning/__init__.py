"""Meaning: names, types and the code that a routine compiles to. All static errors come from here."""
