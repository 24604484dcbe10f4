// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/open_sequence.h"

#include <utility>

#include "datasets/cache/frame_cache.h"
#include "datasets/formats/formats.h"
#include "datasets/io/image_io.h"
#include "datasets/read_sequence.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

/// Decodes the image files of a folder on demand.
class FolderStream : public SensorStream {
 public:
  FolderStream(SequenceContent content, const OpenOptions& options)
      : content_(std::move(content)),
        color_(options.defer_color ? ColorDecoding::kDeferred : ColorDecoding::kWithFrame) {
    if (!options.frame_cache) return;
    cache_ = std::make_unique<FrameCache>(
        content_, *options.frame_cache,
        FrameDecoder{.frame = [this](std::size_t index) { return decode_frame(content_, index, color_); },
                     .color = [this](std::size_t index) { return decode_color(content_, index); }});
  }
  [[nodiscard]] const SequenceInfo& info() const override { return content_.info; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override {
    return cache_ ? cache_->load(index) : decode_frame(content_, index, color_);
  }
  [[nodiscard]] bool frames_are_cached() const override { return cache_ && cache_->complete(); }
  [[nodiscard]] std::optional<MotionLabels> load_labels(std::size_t index) const override {
    const std::filesystem::path& folder = content_.info.folder;
    const std::filesystem::path name = content_.frame_files[index].color.filename();
    for (const char* kind : {"labels", "motion"}) {
      if (!std::filesystem::exists(folder / kind / name)) return std::nullopt;
    }
    return MotionLabels{.object = read_image(folder / "labels" / name),
                        .speed_cm_per_s = read_image(folder / "motion" / name)};
  }

 private:
  SequenceContent content_;
  ColorDecoding color_;
  std::unique_ptr<FrameCache> cache_;  ///< null without a cache
};

}  // namespace

std::string sequence_format_names() {
  std::string names;
  for (const SequenceFormat* const format : kSequenceFormats) {
    names += (names.empty() ? "" : ", ") + std::string(format->name);
  }
  return names;
}

bool is_sequence_path(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ||
         (eval::is_bag(path) && std::filesystem::is_regular_file(path, ignored));
}

std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder, const OpenOptions& options) {
  FaultLog strict;
  return std::make_unique<FolderStream>(read_sequence(folder, options, strict), options);
}

}  // namespace stillpoint::datasets
