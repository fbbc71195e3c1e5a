"""A night at the rig: which cases fit into the time there is, and in which order they are worth running.

`known` gathers what is known of the cases, `plan` chooses by a small integer program, `kept` writes down what was chosen and left out.
"""
