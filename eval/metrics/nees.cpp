// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/nees.h"

#include <Eigen/Cholesky>

#include "core/base/error.h"
#include "core/geometry/so3.h"

namespace stillpoint::eval {
namespace {

double squared_mahalanobis(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                           const char* quantity) {
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  if (factor.info() != Eigen::Success) {
    throw InputError(std::string(quantity) + " covariance", "is not positive definite");
  }
  return error.dot(factor.solve(error));
}

}  // namespace

Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
          const Eigen::Matrix3d& position_covariance) {
  const Eigen::Vector3d rotation_error = -log_so3(gt.q * est.q.conjugate());
  return {squared_mahalanobis(rotation_error, rotation_covariance, "rotation"),
          squared_mahalanobis(gt.p - est.p, position_covariance, "position")};
}

}  // namespace stillpoint::eval
