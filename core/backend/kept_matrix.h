// SPDX-License-Identifier: BSD-3-Clause
/// A matrix whose size changes often and whose memory only grows.
#pragma once

#include <new>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace stillpoint {

/// A value like the matrix or vector `Plain` itself, which would free and ask for memory at each change of
/// size. Assigning an expression gives it the expression's size; to assign by `noalias()`, give it the size
/// before.
template <class Plain>
class KeptMatrix : public Eigen::Map<Plain> {
 public:
  using Base = Eigen::Map<Plain>;

  KeptMatrix() : Base(nullptr, 0, Plain::ColsAtCompileTime == 1 ? 1 : 0) {}
  template <class Expression>
  KeptMatrix(const Eigen::MatrixBase<Expression>& other) : KeptMatrix() {  // NOLINT: as Eigen's own
    *this = other;
  }
  KeptMatrix(const KeptMatrix& other) : KeptMatrix() { *this = other; }
  KeptMatrix(KeptMatrix&& other) noexcept : KeptMatrix() { *this = std::move(other); }
  ~KeptMatrix() = default;

  KeptMatrix& operator=(const KeptMatrix& other) {
    return *this = static_cast<const Eigen::MatrixBase<Base>&>(other);
  }
  KeptMatrix& operator=(KeptMatrix&& other) noexcept {
    const Eigen::Index rows = this->rows(), cols = this->cols();
    std::swap(memory_, other.memory_);
    place(other.rows(), other.cols());
    other.place(rows, cols);
    return *this;
  }
  /// The expression is not of this matrix, unless it has its size.
  template <class Expression>
  KeptMatrix& operator=(const Eigen::MatrixBase<Expression>& other) {
    resize(other.rows(), other.cols());
    Base::operator=(other.derived());
    return *this;
  }

  /// Values are undefined after it.
  void resize(Eigen::Index rows, Eigen::Index cols = 1) {
    const auto size = static_cast<std::size_t>(rows * cols);
    if (size > memory_.size()) memory_.resize(size);
    place(rows, cols);
  }

 private:
  /// A map that has been made is moved by making it anew in its place (Eigen's manual, "Changing the mapped
  /// array").
  void place(Eigen::Index rows, Eigen::Index cols) {
    ::new (static_cast<Base*>(this)) Base(memory_.data(), rows, cols);
  }

  /// Aligned as Eigen's own: where a vectorised loop begins, and so how a sum rounds, must not depend on the
  /// heap.
  std::vector<typename Plain::Scalar, Eigen::aligned_allocator<typename Plain::Scalar>> memory_;
};

using KeptVector = KeptMatrix<Eigen::VectorXd>;

}  // namespace stillpoint
