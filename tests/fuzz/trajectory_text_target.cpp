// SPDX-License-Identifier: BSD-3-Clause
/// Fuzz target that parses arbitrary bytes as every trajectory format. A parser may throw InputError only.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/io/trajectory_file.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kMaxPosesToEvaluate = 64;

/// Evaluates a path against itself: accepted input must not fail in later stages.
void evaluate_itself(const Trajectory& path) {
  if (path.poses.size() > kMaxPosesToEvaluate) return;
  for (const Protocol& protocol : protocols()) {
    try {
      static_cast<void>(protocol.evaluate({path, path, ProtocolOptions{}}));
    } catch (const InputError&) {  // alignment not determined
    }
  }
}

template <class Parse>
void ignore_input_error(const Parse& parse) {
  try {
    parse();
  } catch (const InputError&) {  // rejected
  }
}

void parse_as_every_format(std::string_view text) {
  static_cast<void>(detect_format(text));
  ignore_input_error([&] { evaluate_itself(parse_tum(text, "fuzz").trajectory); });
  ignore_input_error([&] { evaluate_itself(parse_euroc(text, "fuzz").trajectory); });
  const std::size_t middle = text.size() / 2;
  ignore_input_error([&] {
    evaluate_itself(parse_kitti(text.substr(0, middle), "p", text.substr(middle), "t").trajectory);
  });
  ignore_input_error([&] {
    for (const auto& [number, path] : parse_openloris(text, "fuzz").sequences) evaluate_itself(path);
  });
}

}  // namespace
}  // namespace stillpoint::eval

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stillpoint::eval::parse_as_every_format({reinterpret_cast<const char*>(data), size});
  return 0;
}
