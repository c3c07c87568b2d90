"""Try cases for so many seconds, keep what breaks a promise in a folder, and end in 1 if anything did."""

from __future__ import annotations

import argparse
import json
import sys
import time
from itertools import count
from pathlib import Path

from tests.fuzzing.cases import Case, cases
from tests.fuzzing.promises import broken_promise


def main() -> int:
    """Run the fuzzer."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzzing", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--keep", type=Path, default=Path("build/fuzz"))
    asked = parser.parse_args()
    ends = time.monotonic() + asked.seconds
    tried, found = 0, dict[str, int]()
    for number, case in zip(count(), cases(asked.seed), strict=False):
        if time.monotonic() >= ends:
            break
        tried += 1
        what = broken_promise(case)
        if what:
            found[what] = found.get(what, 0) + 1
            if found[what] == 1:
                _keep(asked.keep / f"{asked.seed}-{number}", case, what)
                sys.stdout.write(f"{what}\n  {' '.join(case.arguments)[:200]!r}: {asked.keep}/{asked.seed}-{number}\n")
                sys.stdout.flush()
    sys.stdout.write(
        f"{tried} cases of seed {asked.seed}, {len(found)} kinds of broken promises {list(found.values())}\n"
    )
    return 1 if found else 0


def _keep(folder: Path, case: Case, what: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "case.json").write_text(json.dumps({"arguments": case.arguments, "broken": what}), encoding="utf-8")
    for name, data in case.files.items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    sys.exit(main())
