"""Media of other renderers."""
