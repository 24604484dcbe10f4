// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/open_sequence.h"

#include <utility>

#include "datasets/formats/formats.h"
#include "datasets/io/image_io.h"
#include "datasets/read_sequence.h"

namespace stillpoint::datasets {
namespace {

/// Decodes the image files of a folder on demand.
class FolderStream : public SensorStream {
 public:
  explicit FolderStream(SequenceContent content) : content_(std::move(content)) {}
  [[nodiscard]] const SequenceInfo& info() const override { return content_.info; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override { return decode_frame(content_, index); }
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
};

}  // namespace

std::string sequence_format_names() {
  std::string names;
  for (const SequenceFormat* const format : kSequenceFormats) {
    names += (names.empty() ? "" : ", ") + std::string(format->name);
  }
  return names;
}

std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder, const OpenOptions& options) {
  FaultLog strict;
  return std::make_unique<FolderStream>(read_sequence(folder, options, strict));
}

}  // namespace stillpoint::datasets
