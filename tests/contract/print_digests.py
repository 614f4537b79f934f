"""Program that prints the SIMD level, and a digest of each public function's results; `test_levels` runs it."""

import hashlib
import sys

import numpy as np
import quatfilt as qf
from contract.public_calls import CALLS, samples


def main():
    lines = [qf.simd_level()]
    for dtype in (np.float32, np.float64):
        arguments = samples(dtype)
        for name, call in CALLS.items():
            result = np.ascontiguousarray(call(*arguments))
            lines.append(f"{name} {result.dtype} {hashlib.sha256(result).hexdigest()}")
    sys.stdout.write("\n".join(lines))


if __name__ == "__main__":
    main()
