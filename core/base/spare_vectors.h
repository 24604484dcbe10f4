// SPDX-License-Identifier: BSD-3-Clause
/// Vectors that nobody needs any more, kept for their memory.
#pragma once

#include <utility>
#include <vector>

namespace stillpoint {

template <class T>
class SpareVectors {
 public:
  /// An empty vector; with memory, where one was given.
  [[nodiscard]] std::vector<T> take() {
    std::vector<T> taken;
    if (spare_.empty()) return taken;
    taken = std::move(spare_.back());
    spare_.pop_back();
    return taken;
  }

  void give(std::vector<T> used) {
    if (used.capacity() == 0) return;
    used.clear();
    spare_.push_back(std::move(used));
  }

 private:
  std::vector<std::vector<T>> spare_;
};

}  // namespace stillpoint
