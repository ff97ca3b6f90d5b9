#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <optional>

namespace touchline::calibrate {

/// Ceres cost function: Gaussian prior of one parameter with expected value and standard deviation.
struct Prior {
  std::size_t index;  // index in the parameter block
  double value, sigma;
  template <class T>
  bool operator()(const T* parameters, T* residual) const {
    residual[0] = (parameters[index] - value) / sigma;
    return true;
  }
};

/// Ceres cost function: prior of the logarithm of a positive parameter; `sigma` is the standard deviation of the
/// logarithm.
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

/// Minimizes a small, dense problem without output. Stops when the relative change of the cost is below
/// `function_tolerance` or the relative change of the parameters below `parameter_tolerance`.
ceres::Solver::Summary minimize(ceres::Problem& problem, double function_tolerance, double parameter_tolerance = 1e-8);

/// Returns the covariance of the parameters in the order of their blocks: the inverse of J^T J at the current values.
/// Constant parameters have zeros. Empty if the residuals cannot be evaluated or do not determine the parameters.
std::optional<Eigen::MatrixXd> covariance_of(ceres::Problem& problem);

}  // namespace touchline::calibrate
