"""Values that no slider gives."""

from nested_dielectric.model.parameters import SOCKETS

NAN, INF = float("nan"), float("inf")
BOUNDED = [parameter for parameter in SOCKETS if parameter.limits is not None]

PRIORITIES = (
    (2.5, None),
    (NAN, None),
    (INF, None),
    (-1, None),
    (-0.5, None),
    (1e30, None),
    (1001, None),
    ("1", None),
    ((1, 5, 9), None),
    ((1.0, 1.0), None),
    ((True, True), None),
    (True, 1),
    (3.0, 3),
    ((1, 1, 1), 1),
    ((1.0, 1.0, 1.0, -1.0), None),
)
"""What is stored as an object's own priority, and what it counts as."""
