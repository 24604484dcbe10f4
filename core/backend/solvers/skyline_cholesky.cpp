// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/skyline_cholesky.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint {
namespace {

using Lanes = Eigen::Array4d;
constexpr int kLanes = 4;
using Tile = Eigen::Matrix<double, kTile, kTile>;

/// Three rows of the matrix.
using Rows = std::array<double*, kTile>;

/// Inner products of columns [begin, end) of three rows with three others. Nine independent sums hide the
/// latency of the additions.
Tile inner_products(const Rows& left, const Rows& right, int begin, int end) {
  std::array<Lanes, std::size_t{kTile} * kTile> sums;
  sums.fill(Lanes::Zero());
  int k = begin;
  for (; k + kLanes <= end; k += kLanes) {
    const Lanes right_0 = Eigen::Map<const Lanes>(right[0] + k);
    const Lanes right_1 = Eigen::Map<const Lanes>(right[1] + k);
    const Lanes right_2 = Eigen::Map<const Lanes>(right[2] + k);
    for (std::size_t a = 0; a < kTile; ++a) {
      const Lanes row = Eigen::Map<const Lanes>(left[a] + k);
      sums[3 * a] += row * right_0;
      sums[3 * a + 1] += row * right_1;
      sums[3 * a + 2] += row * right_2;
    }
  }
  Tile products;
  for (std::size_t a = 0; a < kTile; ++a) {
    for (std::size_t b = 0; b < kTile; ++b) {
      products(static_cast<int>(a), static_cast<int>(b)) = sums[3 * a + b].sum();
    }
  }
  for (; k < end; ++k) {
    for (std::size_t a = 0; a < kTile; ++a) {
      for (std::size_t b = 0; b < kTile; ++b) {
        products(static_cast<int>(a), static_cast<int>(b)) += left[a][k] * right[b][k];
      }
    }
  }
  return products;
}

/// Entries of L left of the diagonal tile: solves x L_c^T = rest; the diagonal of L_c is stored inverted.
void solve_tile(const Tile& rest, const Rows& factor, const Rows& rows, int column) {
  for (int a = 0; a < kTile; ++a) {
    double* const x = rows[static_cast<std::size_t>(a)] + column;
    for (int b = 0; b < kTile; ++b) {
      const double* const l = factor[static_cast<std::size_t>(b)] + column;
      double sum = rest(a, b);
      for (int i = 0; i < b; ++i) sum -= x[i] * l[i];
      x[b] = sum * l[b];
    }
  }
}

bool factorize_tile(const Tile& rest, const Rows& rows, int column) {
  for (int a = 0; a < kTile; ++a) {
    double* const x = rows[static_cast<std::size_t>(a)] + column;
    for (int b = 0; b <= a; ++b) {
      const double* const l = rows[static_cast<std::size_t>(b)] + column;
      double sum = rest(a, b);
      for (int i = 0; i < b; ++i) sum -= x[i] * l[i];
      if (a == b && !(sum > 0.0)) return false;
      x[b] = a == b ? 1.0 / std::sqrt(sum) : sum * l[b];
    }
  }
  return true;
}

Rows rows_at(Eigen::Ref<RowMajorMatrix>& S, int row) {
  return {S.row(row).data(), S.row(row + 1).data(), S.row(row + 2).data()};
}

}  // namespace

bool skyline_factorize(std::span<const int> first, Eigen::Ref<RowMajorMatrix> S) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    const int row = kTile * static_cast<int>(i);
    const Rows rows = rows_at(S, row);
    for (int column = first[i]; column <= row; column += kTile) {
      const Rows others = rows_at(S, column);
      const int begin = std::max(first[i], first[static_cast<std::size_t>(column / kTile)]);
      const Tile rest = S.block<kTile, kTile>(row, column) - inner_products(rows, others, begin, column);
      if (column < row) {
        solve_tile(rest, others, rows, column);
      } else if (!factorize_tile(rest, rows, column)) {
        return false;
      }
    }
  }
  return true;
}

void skyline_forward(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                     Eigen::Ref<Eigen::VectorXd> x) {
  for (int row = 0; row < static_cast<int>(x.size()); ++row) {
    const int begin = first[static_cast<std::size_t>(row / kTile)];
    const double sum = factor.row(row).segment(begin, row - begin).dot(x.segment(begin, row - begin));
    x[row] = (x[row] - sum) * factor(row, row);
  }
}

void skyline_forward(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor, int begin,
                     Eigen::Map<ForwardColumns> X) {
  constexpr std::size_t kGroups = ForwardColumns::ColsAtCompileTime / kLanes;
  for (int row = begin; row < static_cast<int>(X.rows()); ++row) {
    std::array<Lanes, kGroups> sums;  // stay in registers
    double* const to = X.row(row).data();
    for (std::size_t group = 0; group < kGroups; ++group) {
      sums[group] = Eigen::Map<const Lanes>(to + kLanes * group);
    }
    for (int k = std::max(begin, first[static_cast<std::size_t>(row / kTile)]); k < row; ++k) {
      const double* const from = X.row(k).data();
      for (std::size_t group = 0; group < kGroups; ++group) {
        sums[group] -= factor(row, k) * Eigen::Map<const Lanes>(from + kLanes * group);
      }
    }
    for (std::size_t group = 0; group < kGroups; ++group) {
      Eigen::Map<Lanes>(to + kLanes * group) = sums[group] * factor(row, row);
    }
  }
}

void skyline_solve(std::span<const int> first, const Eigen::Ref<const RowMajorMatrix>& factor,
                   Eigen::Ref<Eigen::VectorXd> x) {
  skyline_forward(first, factor, x);
  for (int row = static_cast<int>(x.size()) - 1; row >= 0; --row) {
    const int begin = first[static_cast<std::size_t>(row / kTile)];
    x[row] *= factor(row, row);
    x.segment(begin, row - begin) -= x[row] * factor.row(row).segment(begin, row - begin).transpose();
  }
}

}  // namespace stillpoint
