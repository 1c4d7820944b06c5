"""What goes wrong with a render."""


class RenderError(RuntimeError):
    """A render that cannot be started, or that left no picture."""
