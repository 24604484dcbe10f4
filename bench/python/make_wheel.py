# SPDX-License-Identifier: BSD-3-Clause
"""Packs the evaluation of the package into a wheel: stillpoint.eval and what runs the program; no library but numpy.

make_wheel.py PACKAGE_FOLDER VERSION LICENSE OUT_FOLDER
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
Summary: Evaluation of trajectories of SLAM systems: association, alignment, metrics and protocols
License: BSD-3-Clause AND MPL-2.0
Requires-Python: >={python}
Requires-Dist: numpy
"""


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def main():
    package, version, license_file, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4])
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    info = f"stillpoint-{version}.dist-info"
    contents = {f"stillpoint/{name}": (package / name).read_bytes() for name in FILES}
    extension = package / f"_eval{sysconfig.get_config_var('EXT_SUFFIX')}"
    contents[f"stillpoint/{extension.name}"] = extension.read_bytes()
    contents[f"{info}/METADATA"] = METADATA.format(version=version, python=".".join(map(str, sys.version_info[:2]))).encode()
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
