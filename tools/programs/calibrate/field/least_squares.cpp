#include "tools/programs/calibrate/field/least_squares.h"

namespace touchline::calibrate {

ceres::Solver::Summary minimize(ceres::Problem& problem, double function_tolerance, double parameter_tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = function_tolerance;
  options.parameter_tolerance = parameter_tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

}  // namespace touchline::calibrate
