// SPDX-License-Identifier: BSD-3-Clause
/// Pool of unused vectors whose allocated capacity is reused.
#pragma once

#include <utility>
#include <vector>

namespace stillpoint {

template <class T>
class VectorPool {
 public:
  /// An empty vector, with the capacity of a released one if the pool has any.
  [[nodiscard]] std::vector<T> acquire() {
    std::vector<T> vector;
    if (pool_.empty()) return vector;
    vector = std::move(pool_.back());
    pool_.pop_back();
    return vector;
  }

  /// Clears the vector and adds it to the pool; vectors without capacity are discarded.
  void release(std::vector<T> vector) {
    if (vector.capacity() == 0) return;
    vector.clear();
    pool_.push_back(std::move(vector));
  }

 private:
  std::vector<std::vector<T>> pool_;
};

}  // namespace stillpoint
