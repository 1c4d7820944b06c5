"""``make docs``: writes the manual's pages that come from the code, and renders its pictures. Names of pictures render
those anew.
"""

import sys

import pages
import pictures

pages.make()
pictures.make(sys.argv[1:])
