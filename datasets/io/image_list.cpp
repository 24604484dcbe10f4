// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/image_list.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "datasets/io/text_table.h"

namespace stillpoint::datasets {

std::vector<StampedFile> read_image_list(const std::filesystem::path& file, FaultLog& faults) {
  const TextTable table(file);
  std::vector<StampedFile> images;
  images.reserve(table.rows().size());
  table.for_each(faults, [&](const TextRow& row) {
    const StampedFile image{.t = table.seconds(row, 0), .file = file.parent_path() / table.text(row, 1)};
    if (!images.empty()) table.require_increasing(row, images.back().t, image.t);
    images.push_back(image);
  });
  faults.guard([&] {
    if (images.empty()) table.fail("lists no images; is the sequence complete?");
  });
  return images;
}

std::vector<std::pair<std::size_t, std::size_t>> associate(std::span<const StampedFile> a,
                                                           std::span<const StampedFile> b,
                                                           double max_difference_s) {
  const std::int64_t limit_ns = after(Timestamp{0}, max_difference_s).ns;
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  std::size_t first = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (first < b.size() && b[first].t.ns < a[i].t.ns - limit_ns) ++first;
    for (std::size_t j = first; j < b.size() && b[j].t.ns <= a[i].t.ns + limit_ns; ++j) {
      candidates.emplace_back(std::abs(a[i].t.ns - b[j].t.ns), i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> a_used(a.size(), false);
  std::vector<bool> b_used(b.size(), false);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (a_used[i] || b_used[j]) continue;
    a_used[i] = b_used[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace stillpoint::datasets
