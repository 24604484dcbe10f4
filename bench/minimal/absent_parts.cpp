// SPDX-License-Identifier: BSD-3-Clause
// What the commands of the minimal build (STILLPOINT_MINIMAL) could call, but which it does not have: the
// renderer and the registry of sequences, descriptions of other systems, PDF and PNG files, map
// tiles, the files of pages, and recordings for viewers.
#include "bench/config/toml_source.h"
#include "bench/plan/plan_sequences.h"
#include "bench/run/sequence_source.h"
#include "bench/systems/external_system.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "datasets/tiles/map_tiles.h"
#include "reports/drawing/drawing_module.h"
#include "reports/frames/run_recording.h"

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
                                                             const synth::RenderControl&, const PresetPart&) {
  return datasets::open_sequence(name, options);
}

bool bench::is_description(const std::string&) { return false; }

/// Never reached: nothing is a description.
bench::ExternalSystem bench::load_external_system(const std::string& name) {
  throw InputError(name, "this build executes no other systems (STILLPOINT_MINIMAL); use a full build");
}
std::vector<bench::DifferentKey> bench::different_keys(const ExternalSystem&, const ExternalSystem&) {
  return {};
}

std::span<const bench::EmbeddedFile> bench::web_files() { return {}; }

void datasets::require_map_tiles(const MapTiles&) {
  throw InputError("--map-tiles", "this build has no map tiles (STILLPOINT_MINIMAL); use a full build");
}

/// Never reached: they are required before.
std::vector<std::uint8_t> datasets::map_image(const MapTiles&, const MapWindow&) { return {}; }

const report::DrawingModule* report::drawing_module() { return nullptr; }

report::RunRecording::RunRecording(const std::filesystem::path& file, const datasets::SequenceInfo&,
                                   RecordedImages) {
  throw InputError(file.string(), "this build writes no MCAP files (STILLPOINT_MINIMAL); use a full build");
}

/// Never reached: there is no recording.
void report::RunRecording::add(const FrameReport&) {}
void report::RunRecording::finish(const bench::LoopRun*) {}

}  // namespace stillpoint
