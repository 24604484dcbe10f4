// SPDX-License-Identifier: BSD-3-Clause
/// A dynamic matrix that keeps its allocation when its size changes.
#pragma once

#include <algorithm>
#include <new>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace stillpoint {

/// Behaves like the matrix or vector `Plain`, but reallocates only to grow (Eigen reallocates at each change
/// of size). Assigning an expression resizes to its size; before an assignment by `noalias()` call `resize`.
template <class Plain>
class ReusableMatrix : public Eigen::Map<Plain> {
 public:
  using Base = Eigen::Map<Plain>;

  ReusableMatrix() : Base(nullptr, 0, std::max<int>(Plain::ColsAtCompileTime, 0)) {}
  template <class Expression>
  ReusableMatrix(const Eigen::MatrixBase<Expression>& other) : ReusableMatrix() {  // NOLINT: as Eigen's own
    *this = other;
  }
  ReusableMatrix(const ReusableMatrix& other) : ReusableMatrix() { *this = other; }
  ReusableMatrix(ReusableMatrix&& other) noexcept : ReusableMatrix() { *this = std::move(other); }
  ~ReusableMatrix() = default;

  ReusableMatrix& operator=(const ReusableMatrix& other) {
    return *this = static_cast<const Eigen::MatrixBase<Base>&>(other);
  }
  ReusableMatrix& operator=(ReusableMatrix&& other) noexcept {
    const Eigen::Index rows = this->rows(), cols = this->cols();
    std::swap(buffer_, other.buffer_);
    remap(other.rows(), other.cols());
    other.remap(rows, cols);
    return *this;
  }
  /// An expression that reads this matrix must have its size.
  template <class Expression>
  ReusableMatrix& operator=(const Eigen::MatrixBase<Expression>& other) {
    resize(other.rows(), other.cols());
    Base::operator=(other.derived());
    return *this;
  }

  /// The values are undefined afterwards.
  void resize(Eigen::Index rows, Eigen::Index cols = 1) {
    const auto size = static_cast<std::size_t>(rows * cols);
    if (size > buffer_.size()) buffer_.resize(size);
    remap(rows, cols);
  }

 private:
  /// Re-seats the map by placement new (Eigen manual, "Changing the mapped array").
  void remap(Eigen::Index rows, Eigen::Index cols) {
    ::new (static_cast<Base*>(this)) Base(buffer_.data(), rows, cols);
  }

  /// Aligned like Eigen's matrices: the start of vectorized loops, and thereby the rounding of sums, must not
  /// depend on the heap.
  std::vector<typename Plain::Scalar, Eigen::aligned_allocator<typename Plain::Scalar>> buffer_;
};

using ReusableVector = ReusableMatrix<Eigen::VectorXd>;

}  // namespace stillpoint
