# SPDX-License-Identifier: BSD-3-Clause
# Stands for a Ceres that somebody built by hand without SuiteSparse.
set(Ceres_FOUND TRUE)
set(CERES_COMPILED_COMPONENTS EigenSparse SparseLinearAlgebraLibrary LAPACK)
