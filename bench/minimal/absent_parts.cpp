// SPDX-License-Identifier: BSD-3-Clause
// What the commands of the minimal build (STILLPOINT_MINIMAL) could call, but which it does not have: the
// renderer and the registry of sequences, PDF files, and the files of pages.
#include "bench/config/toml_source.h"
#include "bench/plan/plan_sequences.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "reports/drawing/drawing.h"

namespace stillpoint {

std::string bench::resolve_sequence(const std::string& given) {
  if (datasets::is_sequence_path(given)) return given;
  throw InputError(
      "sequence \"" + given + "\"",
      "is not a folder, and this build has no renderer and no registered sequences "
      "(STILLPOINT_MINIMAL); render it with a full build, `stillpoint data synth`, or specify a folder");
}

std::unique_ptr<datasets::SensorStream> bench::find_sequence(const std::string& name,
                                                             const datasets::OpenOptions& options,
                                                             const synth::RenderControl&) {
  return datasets::open_sequence(name, options);
}

std::span<const bench::EmbeddedFile> bench::web_files() { return {}; }

std::string report::pdf_text(const Drawing&) {
  throw InputError("PDF", "this build writes none (STILLPOINT_MINIMAL); write .svg, or use a full build");
}

}  // namespace stillpoint
