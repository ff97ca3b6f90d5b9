#pragma once

#include <Eigen/Core>

#include "core/track/drive_filter.h"

// The matrices of DriveFilter, for its sources.
namespace touchline::drive {

constexpr int kN = static_cast<int>(DriveFilter::kStates);
using Vector = Eigen::Matrix<double, kN, 1>;
using Matrix = Eigen::Matrix<double, kN, kN, Eigen::RowMajor>;
using VectorMap = Eigen::Map<Vector>;
using MatrixMap = Eigen::Map<Matrix>;
using ConstMatrixMap = Eigen::Map<const Matrix>;
using LastingMatrix = Eigen::Matrix<double, kN, 3, Eigen::RowMajor>;
using LastingMap = Eigen::Map<LastingMatrix>;
using ConstLastingMap = Eigen::Map<const LastingMatrix>;

inline void symmetrize(MatrixMap p) {
  for (int i = 0; i < kN; ++i) {
    for (int k = 0; k < i; ++k) p(i, k) = p(k, i) = 0.5 * (p(i, k) + p(k, i));
  }
}

}  // namespace touchline::drive
