"""The glass of iced water."""
