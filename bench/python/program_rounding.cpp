// SPDX-License-Identifier: BSD-3-Clause
/// The copies of shared inline functions that the program uses. The linker takes the first of a function that
/// several sources emit; in the program that is one with the options of bench
/// (scripts/cmake/precompiled.cmake), which rounds some products and sums in another order than the copy of
/// eval. Linked first, this source gives the module the same bits.
#include <Eigen/Core>
#include <Eigen/Geometry>

using Rotation = Eigen::Quaterniond;

template struct Eigen::internal::quat_product<1, Rotation, Rotation, double>;
template Eigen::Vector3d Eigen::QuaternionBase<Rotation>::_transformVector(const Eigen::Vector3d&) const;
template void Eigen::internal::quaternionbase_assign_impl<Eigen::Matrix3d, 3, 3>::run<Rotation>(
    Eigen::QuaternionBase<Rotation>&, const Eigen::Matrix3d&);
