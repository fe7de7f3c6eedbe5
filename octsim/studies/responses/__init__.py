"""What else than its diameter may move a neuron's phase, and how far that is told apart."""
