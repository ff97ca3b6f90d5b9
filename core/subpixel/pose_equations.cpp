#include "core/subpixel/pose_equations.h"

#include <cmath>
#include <cstddef>

namespace touchline {
namespace {

// Least determinant relative to the product of the diagonal. For two patches it is above 0.1; it is 0 if all edges have
// one direction, or pass through one point.
constexpr float kMinPoseDeterminant = 0.003f;

}  // namespace

float dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3 product(const Matrix3& m, const Vector3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

bool invert(const Matrix3& m, Matrix3& out) {
  const auto cofactor = [&m](std::size_t i, std::size_t j) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return m[a][c] * m[b][d] - m[a][d] * m[b][c];
  };
  const float determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  if (!(determinant > kMinPoseDeterminant * m[0][0] * m[1][1] * m[2][2])) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out[i][j] = cofactor(j, i) / determinant;
  }
  return true;
}

void PoseEquations::operator+=(const PoseEquations& other) {
  for (std::size_t i = 0; i < 3; ++i) {
    right[i] += other.right[i];
    for (std::size_t j = 0; j < 3; ++j) normal[i][j] += other.normal[i][j];
  }
}

Matrix3 patch_by_pose(const PatchPlace& place, float arm_m) {
  const float c = std::cos(place.turn_rad), s = std::sin(place.turn_rad);
  const float x_by_turn = -place.y_m / arm_m, y_by_turn = place.x_m / arm_m;
  return {{{c, s, c * x_by_turn + s * y_by_turn}, {-s, c, c * y_by_turn - s * x_by_turn}, {0, 0, 1.0f / arm_m}}};
}

PoseEquations pose_equations(const CenterEquations& edge, const Matrix3& by_pose) {
  const Matrix3 own{{{edge.xx, edge.xy, edge.xt}, {edge.xy, edge.yy, edge.yt}, {edge.xt, edge.yt, edge.tt}}};
  const Vector3 right{edge.rx, edge.ry, edge.rt};
  PoseEquations out;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 by_i{by_pose[0][i], by_pose[1][i], by_pose[2][i]};
    const Vector3 with = product(own, by_i);
    out.right[i] = dot(right, by_i);
    for (std::size_t j = 0; j < 3; ++j) {
      out.normal[i][j] = with[0] * by_pose[0][j] + with[1] * by_pose[1][j] + with[2] * by_pose[2][j];
    }
  }
  return out;
}

}  // namespace touchline
