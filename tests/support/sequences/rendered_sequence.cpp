// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/sequences/rendered_sequence.h"

#include <stdexcept>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// Renders unless another test program of this build did so after this program was linked.
/// @param sequence receives a copy of the rendering
void provide_sequence(const fs::path& sequence) {
  const fs::path shared = STILLPOINT_BINARY_DIR "/tests/rendered_sequence";
  const int lock = open((shared.string() + ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock < 0 || flock(lock, LOCK_EX) != 0) throw std::runtime_error(shared.string() + ": cannot be locked");
  if (!fs::exists(shared) || fs::last_write_time(shared) < fs::last_write_time("/proc/self/exe")) {
    fs::remove_all(shared);
    synth::SynthRequest request = synth::preset_request("walking_xyz_empty");
    request.seconds = 3.0;
    request.focal_px *= static_cast<double>(kWidth) / request.width;
    request.width = kWidth;
    request.height = kHeight;
    synth::render_sequence(request, shared);
  }
  fs::copy(shared, sequence, fs::copy_options::recursive);
  close(lock);
}

/// The folder is removed when the test program ends.
struct Rendering {
  TemporaryFolder folder;
  fs::path sequence = folder.path() / "office";
  Rendering() { provide_sequence(sequence); }
};

void link_or_copy(const fs::path& from, const fs::path& to) {
  if (from.extension() == ".png") {
    fs::create_hard_link(from, to);
  } else {
    fs::copy_file(from, to);
  }
}

}  // namespace

const fs::path& rendered_sequence() {
  static const Rendering kRendering;
  return kRendering.sequence;
}

fs::path copy_of_rendered_sequence(const TemporaryFolder& folder) {
  const fs::path copy = folder.path() / "copy";
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(rendered_sequence())) {
    const fs::path target = copy / entry.path().lexically_relative(rendered_sequence());
    fs::create_directories(entry.is_directory() ? target : target.parent_path());
    if (entry.is_regular_file()) link_or_copy(entry.path(), target);
  }
  return copy;
}

}  // namespace stillpoint
