#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace touchline {

/// Inverse of a symmetric, positive definite matrix in row-major order, by its Cholesky factor. Eigen's decompositions
/// of matrices of this size contain calls of malloc. A matrix that is not positive definite gives large values.
template <std::size_t N>
std::array<double, N * N> inverse_of(const std::array<double, N * N>& matrix) {
  constexpr double kMinPivot = 1e-300;
  std::array<double, N * N> lower{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      double rest = matrix[i * N + k];
      for (std::size_t j = 0; j < k; ++j) rest -= lower[i * N + j] * lower[k * N + j];
      lower[i * N + k] = i == k ? std::sqrt(std::max(rest, kMinPivot)) : rest / lower[k * N + k];
    }
  }
  std::array<double, N * N> inverse{};
  for (std::size_t column = 0; column < N; ++column) {
    std::array<double, N> x{};
    for (std::size_t i = 0; i < N; ++i) {
      double rest = i == column ? 1.0 : 0.0;
      for (std::size_t j = 0; j < i; ++j) rest -= lower[i * N + j] * x[j];
      x[i] = rest / lower[i * N + i];
    }
    for (std::size_t i = N; i-- > 0;) {
      for (std::size_t j = i + 1; j < N; ++j) x[i] -= lower[j * N + i] * x[j];
      x[i] /= lower[i * N + i];
    }
    for (std::size_t i = 0; i < N; ++i) inverse[i * N + column] = x[i];
  }
  return inverse;
}

}  // namespace touchline
