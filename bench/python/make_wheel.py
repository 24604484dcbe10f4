# SPDX-License-Identifier: BSD-3-Clause
"""Packs the package into a wheel: stillpoint.eval and what runs the program, with no library but numpy; or, with "full", all of it.

make_wheel.py PACKAGE_FOLDER VERSION LICENSE OUT_FOLDER [full]
"""

import base64
import hashlib
import sys
import sysconfig
import zipfile
from pathlib import Path

FILES = ("__init__.py", "eval.py", "runs.py", "_eval.pyi", "py.typed")
METADATA = """Metadata-Version: 2.1
Name: stillpoint
Version: {version}
Summary: {summary}
License: {license}
Requires-Python: >={python}
Requires-Dist: numpy
{description}"""
EVALUATION = {
    "summary": "Evaluation of trajectories of SLAM systems: association, alignment, metrics and protocols",
    "license": "BSD-3-Clause AND MPL-2.0",
    "description": "",
}
FULL = {
    "summary": "RGB-D inertial odometry in dynamic scenes, its evaluation and its benchmarks",
    "license": "GPL-2.0-or-later",
    "description": """
The sources of this package are under the BSD license. Its odometry is linked with SuiteSparse, parts of which (the supernodal
module of CHOLMOD, SPQR) are under the GPL: the GPL applies to this wheel as a whole when it is redistributed. It uses the shared
libraries of the system on which it was built, and is for that system only.
""",
}


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def main():
    package, version, license_file, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4])
    full = sys.argv[5:] == ["full"]
    version += "+full" if full else ""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    info = f"stillpoint-{version}.dist-info"
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    names = sorted(path.name for path in package.iterdir() if path.is_file()) if full else (*FILES, f"_eval{suffix}")
    contents = {f"stillpoint/{name}": (package / name).read_bytes() for name in names}
    metadata = METADATA.format(version=version, python=".".join(map(str, sys.version_info[:2])), **(FULL if full else EVALUATION))
    contents[f"{info}/METADATA"] = metadata.encode()
    contents[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: stillpoint\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    contents[f"{info}/LICENSE"] = license_file.read_bytes()
    record = "".join(record_line(name, data) for name, data in contents.items()) + f"{info}/RECORD,,\n"
    contents[f"{info}/RECORD"] = record.encode()
    out.mkdir(parents=True, exist_ok=True)
    wheel = out / f"stillpoint-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in contents.items():
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED)
    print(wheel)


if __name__ == "__main__":
    main()
