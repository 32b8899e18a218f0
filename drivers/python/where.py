"""where.py PREFIX: the folder below PREFIX in which this Python looks for modules; lib/pythonX.Y/site-packages where it
looks in none."""

import pathlib
import site
import sys

prefix = pathlib.Path(sys.argv[1])
for folder in site.getsitepackages() + [site.getusersitepackages()] + sys.path:
    path = pathlib.Path(folder)
    # Not /usr/local for /usr.
    if prefix in path.parents and path.relative_to(prefix).parts[0].startswith("lib"):
        print(path.relative_to(prefix))
        break
else:
    print("lib/python{}.{}/site-packages".format(*sys.version_info[:2]))
