// SPDX-License-Identifier: BSD-3-Clause
/// Any bytes as trajectory text: a reader may refuse them with an InputError, and nothing else may happen.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "eval/io/any_trajectory.h"
#include "eval/io/euroc_file.h"
#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/recipes/recipe.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMaxPosesToScore = 64;

/// Scores a path against itself: what was accepted must be fit for use.
void score_itself(const Trajectory& path) {
  if (path.poses.size() > kMaxPosesToScore) return;
  for (const Recipe& recipe : recipes()) {
    try {
      static_cast<void>(recipe.evaluate({path, path, RecipeOptions{}}));
    } catch (const InputError&) {  // an alignment that the path leaves open
    }
  }
}

template <class Parse>
void try_to(const Parse& parse) {
  try {
    parse();
  } catch (const InputError&) {  // the one way to refuse
  }
}

void read_as_every_format(std::string_view text) {
  static_cast<void>(recognise_format(text));
  try_to([&] { score_itself(parse_tum(text, "fuzz").trajectory); });
  try_to([&] { score_itself(parse_euroc(text, "fuzz").trajectory); });
  const std::size_t middle = text.size() / 2;
  try_to(
      [&] { score_itself(parse_kitti(text.substr(0, middle), "p", text.substr(middle), "t").trajectory); });
  try_to([&] {
    for (const auto& [number, path] : parse_openloris(text, "fuzz").sequences) score_itself(path);
  });
}

}  // namespace
}  // namespace stillpoint

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  stillpoint::read_as_every_format({reinterpret_cast<const char*>(data), size});
  return 0;
}
