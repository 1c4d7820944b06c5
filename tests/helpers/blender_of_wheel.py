"""Stand for a Blender application: ``[--factory-startup] -b FILE --python-exit-code N --python SCRIPT -- ARGUMENTS``.

The wheel opens the file and runs the script as an application does, which ends with a script's ``sys.exit`` and its code. No
``nested_dielectric`` is installed in it.
"""

import runpy
import sys
import traceback

import bpy

arguments = sys.argv[1:]
before = arguments[: arguments.index("--")]
file, code, script = (before[before.index(option) + 1] for option in ("-b", "--python-exit-code", "--python"))

# The project itself is installed in this Python, by a finder of its own.
sys.meta_path[:] = [finder for finder in sys.meta_path if "editable" not in str(finder)]
bpy.utils.expose_bundled_modules()
bpy.ops.wm.open_mainfile(filepath=file)
sys.argv = ["blender", *arguments]
try:
    runpy.run_path(script, run_name="__main__")
except Exception:
    traceback.print_exc()
    sys.exit(int(code))
