// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/render_sequence.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "datasets/cache/cache_space.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

/// Calls `work(index)` once for every index below `count`, from several threads. The first exception stops
/// all threads and is rethrown.
/// @return false if stopped by `control`
template <class Work>
bool for_each_frame(int count, const RenderControl& control, const Work& work) {
  std::atomic<int> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  int done = 0;
  std::exception_ptr error;
  const auto run = [&] {
    while (!stopped) {
      if (control.stop_requested && control.stop_requested()) stopped = true;
      const int index = next++;
      if (stopped || index >= count) return;
      try {
        work(index);
        const std::scoped_lock lock(mutex);
        if (control.progress) control.progress(++done, count);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
        stopped = true;
      }
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = control.threads > 0 ? static_cast<unsigned>(control.threads) : cores;
  {
    std::vector<std::jthread> pool;
    for (unsigned i = 0; i < threads; ++i) pool.emplace_back(run);
  }
  if (error) std::rethrow_exception(error);
  return !stopped;
}

/// A folder that is removed on destruction unless it was renamed.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  void rename_to(const fs::path& name) {
    std::error_code error;
    fs::rename(path_, name, error);
    if (error)
      throw InputError(name.string(), "cannot be created (" + error.message() + "); choose another folder");
  }

 private:
  fs::path path_;
};

}  // namespace

bool render_frames(SequenceRendering& rendering, std::size_t count, const RenderControl& control) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < count; ++i) {
    if (!rendering.is_rendered(i)) missing.push_back(i);
  }
  return for_each_frame(static_cast<int>(missing.size()), control, [&](int i) {
    rendering.render(missing[static_cast<std::size_t>(i)], control.on_images);
  });
}

bool render_sequence(const SynthRequest& request, const fs::path& folder, const RenderControl& control) {
  check_request(request);
  if (fs::exists(folder))
    throw InputError(folder.string(), "already exists; remove it or choose another folder");
  TemporaryFolder partial(folder.string() + ".partial-" + std::to_string(::getpid()));
  SequenceRendering rendering(request, partial.path());
  if (!render_frames(rendering, rendering.frame_count(), control)) return false;
  partial.rename_to(folder);
  return true;
}

fs::path sequence_cache_folder(const SynthRequest& request) {
  check_request(request);
  // The last path component is the name shown in tables: preset and seed. The key is the parent folder.
  const std::string name = request.preset + "_" + std::to_string(request.seed);
  return datasets::cache_folder() / "synthetic" / request_key(request) / name;
}

bool is_complete_sequence(const fs::path& folder) { return fs::exists(folder / "detections.txt"); }

fs::path cached_sequence(const SynthRequest& request, const RenderControl& control) {
  fs::path folder = sequence_cache_folder(request);
  if (is_complete_sequence(folder)) return folder;
  SequenceRendering rendering(request, folder);
  return render_frames(rendering, rendering.frame_count(), control) ? folder : fs::path();
}

}  // namespace stillpoint::synth
