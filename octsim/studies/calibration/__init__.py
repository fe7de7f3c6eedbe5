"""From a phase to nanometres, and how surely."""
