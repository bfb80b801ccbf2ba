"""Printer G-code to OpenVDB level sets to ray-traced pictures, on NumPy arrays.

Lengths are millimetres and times seconds unless a docstring says otherwise. Long calls run without the GIL on all
processors, take progress=, and end with KeyboardInterrupt after Ctrl-C. All objects may be used from several threads.
"""

try:
    import numpy as _numpy  # noqa: F401  the module makes arrays
except ImportError as _error:
    raise ImportError("stratum needs NumPy: install python3-numpy (Debian) or numpy (pip)") from _error

from . import _stratum
from ._stratum import *  # noqa: F401, F403
from ._stratum import __version__

__all__ = [_name for _name in dir(_stratum) if not _name.startswith("_")]
for _name in __all__:
    if callable(getattr(_stratum, _name)) and hasattr(getattr(_stratum, _name), "__module__"):
        try:
            getattr(_stratum, _name).__module__ = "stratum"  # where users find it
        except (AttributeError, TypeError):
            pass  # a function of C
del _name, _numpy, _stratum
