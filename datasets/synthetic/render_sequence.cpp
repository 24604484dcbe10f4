// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render_sequence.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/sequence_writer.h"
#include "datasets/synthetic/stage.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Calls `work(index)` for all indices below `count`, each once, from several threads; the first error ends
/// all.
/// @return false if it was stopped
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

/// A folder that vanishes unless it is kept.
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
  void keep_as(const fs::path& name) {
    std::error_code error;
    fs::rename(path_, name, error);
    if (error)
      throw InputError(name.string(), "cannot be made (" + error.message() + "); choose another folder");
  }

 private:
  fs::path path_;
};

bool render_pictures(const SynthRequest& request, const Stage& stage, const std::vector<Timestamp>& times,
                     const SequenceWriter& writer, const RenderControl& control) {
  const RayTracer tracer(stage.scene.world);
  const FrameRenderer renderer(stage.scene.world, tracer, stage.rig.camera);
  const double span_s = std::max(1e-3, request.color.exposure_s + request.rolling_shutter_s);
  return for_each_frame(static_cast<int>(times.size()), control, [&](int index) {
    const Timestamp t = times[static_cast<std::size_t>(index)];
    const auto frame_number = static_cast<std::uint64_t>(index);
    const RenderedFrame frame = renderer.render(shot_at(request, stage, t, span_s), nullptr);
    const double gain = stage.scene.gain * exposure_gain(request.color, seconds_between(times.front(), t));
    writer.write_pictures(t,
                          develop(frame, stage.rig.camera, request.color, gain,
                                  random_key(request.seed, RandomStream::kColorNoise, frame_number)),
                          measure_depth(frame.depth_m, frame.width, frame.height, request.depth,
                                        random_key(request.seed, RandomStream::kDepthNoise, frame_number)));
  });
}

}  // namespace

bool render_sequence(const SynthRequest& request, const fs::path& folder, const RenderControl& control) {
  check_request(request);
  if (fs::exists(folder))
    throw InputError(folder.string(), "exists already; remove it or choose another folder");
  const Stage stage = make_stage(request);
  const std::vector<Timestamp> times = frame_times(request, stage);

  TemporaryFolder partial(folder.string() + ".partial-" + std::to_string(::getpid()));
  const SequenceWriter writer(partial.path(), request.layout, request.labels);
  if (!render_pictures(request, stage, times, writer, control)) return false;
  writer.write_lists(times);
  writer.write_request(request);
  writer.write_rig(stage.rig, request);
  writer.write_inertia(stage.inertia);
  writer.write_ground_truth(camera_truth(request, stage));
  partial.keep_as(folder);
  return true;
}

}  // namespace stillpoint
