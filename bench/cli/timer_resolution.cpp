// SPDX-License-Identifier: BSD-3-Clause
// Highway measures the resolution of the processor's timer for its micro-benchmarks whenever its shared
// library is loaded, with an instruction (rdtscp) that valgrind rejects on processors, mostly virtual ones,
// that do not report it: no run could count instructions there. This definition in the program takes
// precedence over that of the library; nothing here uses the value.
#include <cstdint>

namespace hwy::platform {

[[gnu::visibility("default")]] std::uint64_t TimerResolution();
std::uint64_t TimerResolution() { return 1; }

}  // namespace hwy::platform
