"""Whether a lab's neuron is what the config says: its spectrum beside those of the model."""
