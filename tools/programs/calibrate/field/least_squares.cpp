#include "tools/programs/calibrate/field/least_squares.h"

#include <Eigen/Dense>

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

std::optional<Eigen::MatrixXd> covariance_of(ceres::Problem& problem) {
  ceres::CRSMatrix sparse;
  if (!problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse)) return std::nullopt;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[static_cast<std::size_t>(row)]; i < sparse.rows[static_cast<std::size_t>(row) + 1]; ++i) {
      jacobian(row, sparse.cols[static_cast<std::size_t>(i)]) = sparse.values[static_cast<std::size_t>(i)];
    }
  }
  // Scales the columns, because the units of the parameters differ by orders of magnitude. Columns of constant
  // parameters are zero.
  const Eigen::VectorXd norms = jacobian.colwise().norm();
  const Eigen::VectorXd scale = norms.unaryExpr([](double n) { return n > 0.0 ? 1.0 / n : 0.0; });
  jacobian = jacobian * scale.asDiagonal();
  Eigen::MatrixXd squares = jacobian.transpose() * jacobian;
  for (Eigen::Index i = 0; i < norms.size(); ++i) {
    if (norms(i) == 0.0) squares(i, i) = 1.0;
  }
  const Eigen::LDLT<Eigen::MatrixXd> normal(squares);
  // Then the residuals do not determine some parameter, which LDLT would treat as exact.
  if (normal.info() != Eigen::Success || !(normal.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Eigen::MatrixXd inverse = normal.solve(Eigen::MatrixXd::Identity(sparse.num_cols, sparse.num_cols));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace touchline::calibrate
