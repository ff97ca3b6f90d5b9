#pragma once

#include <ceres/ceres.h>

#include <cmath>
#include <cstddef>

namespace touchline::calibrate {

/// A cost function for ceres: what an unknown is expected to be, and how surely.
struct Prior {
  std::size_t index;  // in its parameter block
  double value, sigma;
  template <class T>
  bool operator()(const T* parameters, T* residual) const {
    residual[0] = (parameters[index] - value) / sigma;
    return true;
  }
};

/// The same for a positive unknown of which only the size is known: `sigma` is that of its logarithm.
struct LogPrior {
  std::size_t index;
  double value, sigma;
  template <class T>
  bool operator()(const T* parameters, T* residual) const {
    using std::log;
    if (parameters[index] <= T(0)) return false;
    residual[0] = log(parameters[index] / value) / sigma;
    return true;
  }
};

/// Minimizes a small, dense problem in silence. `function_tolerance`, `parameter_tolerance`: relative changes of the
/// cost and of the unknowns below which it ends.
ceres::Solver::Summary minimize(ceres::Problem& problem, double function_tolerance, double parameter_tolerance = 1e-8);

}  // namespace touchline::calibrate
