"""The Blender extension: the package in addon/, under the name that Blender gives it."""

from .addon import *
from .addon import __all__ as __all__
