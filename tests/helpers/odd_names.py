"""Names that artists may give, and that programs stumble over."""

ODD_NAMES = (
    'quo"te',
    "back\\slash",
    "new\nline",
    '"]["nd_priority',
    "x" * 63,
    "é" * 31,
    "מים בכוס",
    "\u202eabc\u202c",
    "💧" * 15,
    "{name} %s $F ##",
    " lead ",
    ".hidden",
    "//slashes",
    "apo's\ttab",
    "Nested Dielectric",
    "all",
    "a (cut)",
    "x" * 59 + ".001",
)
"""Blender cuts names at 63 bytes, in between characters."""
