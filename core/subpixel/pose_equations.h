#pragma once

#include <array>

#include "core/marker/marker_layout.h"
#include "core/subpixel/fit_kernel.h"

namespace touchline {

using Vector3 = std::array<float, 3>;
using Matrix3 = std::array<Vector3, 3>;

float dot(const Vector3& a, const Vector3& b);
Vector3 product(const Matrix3& m, const Vector3& v);

/// Inverts a symmetric matrix with a positive diagonal. False if it is nearly singular.
bool invert(const Matrix3& m, Matrix3& out);

/// Normal equations of least squares for the pose of a robot, in its own frame: x, y, and the turn times `arm_m`, so
/// that all three are in meters. README.md derives them.
struct PoseEquations {
  Matrix3 normal{};
  Vector3 right{};

  void operator+=(const PoseEquations& other);
};

/// Derivatives of a patch by the pose: of its center along the axes of its outline (two rows, meters), and of the
/// outline's turn (radians).
Matrix3 patch_by_pose(const PatchPlace& place, float arm_m);

/// Returns the equations of one patch's edge in terms of the pose. `by_pose`: patch_by_pose().
PoseEquations pose_equations(const CenterEquations& edge, const Matrix3& by_pose);

}  // namespace touchline
