"""A config's instrument: points traced, or taken from where they are kept."""
