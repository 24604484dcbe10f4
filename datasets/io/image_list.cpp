// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_list.h"

namespace stillpoint::datasets {

std::vector<StampedFile> read_image_list(const std::filesystem::path& list, const std::filesystem::path& root,
                                         eval::TimeUnit unit, FaultLog& faults) {
  const std::string text = eval::read_text_file(list);
  const std::string name = list.string();
  std::vector<StampedFile> images;
  eval::for_each_row(text, name, faults, [&](const eval::TextRow& row) {
    const StampedFile image{.t = row.time(0, unit), .file = root / row.text(1)};
    if (!images.empty()) row.require_increasing(images.back().t, image.t);
    images.push_back(image);
  });
  faults.guard([&] {
    if (images.empty()) throw InputError(name, "lists no images; is the sequence complete?");
  });
  return images;
}

}  // namespace stillpoint::datasets
