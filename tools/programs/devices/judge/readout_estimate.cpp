#include "tools/programs/devices/judge/readout_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "tools/programs/statistics/statistics.h"

namespace touchline::devices {
namespace {

// Number of frames before and after from which a velocity is computed. The five-point formula is exact up to the fourth
// power of time, so for a hand that oscillates at 2 Hz in front of a camera of 30 Hz the error is 0.1 %.
constexpr std::size_t kReach = 2;
// A slow computer processes only every second or third frame.
constexpr std::uint32_t kLargestStep = 3;
// A track with fewer samples adds little information, because each track has eight unknowns of its own.
constexpr std::size_t kMinSamples = 40;
// Number of blocks with independent errors. Fewer blocks give no estimate of the uncertainty.
constexpr std::size_t kMinBlocks = 6;
// Residuals beyond this many standard deviations come from collisions, or from two objects that touch.
constexpr double kOutlier = 4.0;

// Side of a cell in squares of the luma picture. A line behind the object, a few squares wide, changes the object's
// shape within a few squares.
constexpr double kCell = 4.0;
// Mean number of equations per cell below which comparing within cells would lose most of them.
constexpr std::size_t kMinVisits = 3;

/// One equation: `shape` = `other` unknowns + t * `velocity`.
struct Equation {
  double shape = 0.0, velocity = 0.0;
  std::vector<double> other;
  std::size_t block = 0;
  std::uint64_t cell = 0;  // cell of the picture
};

/// Subtracts from each equation the mean of all equations in its cell of the picture. Effects that depend only on the
/// position cancel: lines on the floor behind the object, perspective, light. An equation that is alone in its cell is
/// lost, so nothing is done if the object rarely came to the same position again.
void compare_within_cells(std::vector<Equation>& equations) {
  std::map<std::uint64_t, std::vector<Equation*>> cells;
  for (Equation& equation : equations) cells[equation.cell].push_back(&equation);
  if (cells.size() * kMinVisits > equations.size()) return;
  for (auto& [cell, members] : cells) {
    const auto count = static_cast<double>(members.size());
    Equation mean;
    mean.other.assign(members[0]->other.size(), 0.0);
    for (const Equation* member : members) {
      mean.shape += member->shape / count;
      mean.velocity += member->velocity / count;
      for (std::size_t k = 0; k < mean.other.size(); ++k) mean.other[k] += member->other[k] / count;
    }
    for (Equation* member : members) {
      member->shape -= mean.shape;
      member->velocity -= mean.velocity;
      for (std::size_t k = 0; k < mean.other.size(); ++k) member->other[k] -= mean.other[k];
    }
  }
}

/// Weighted sums of a regression from which the other unknowns were removed. The weight is the inverse variance of the
/// residuals.
struct Slope {
  double weight = 0.0, moment = 0.0;  // the slope is moment / weight
  double score_squares = 0.0;
  std::size_t used = 0, blocks = 0;
};

std::optional<Slope> regress(const std::vector<Equation>& equations, const std::vector<bool>& used) {
  const auto rows = static_cast<Eigen::Index>(std::count(used.begin(), used.end(), true));
  if (rows < static_cast<Eigen::Index>(kMinSamples)) return std::nullopt;
  const auto unknowns = static_cast<Eigen::Index>(equations[0].other.size());
  Eigen::MatrixXd other(rows, unknowns);
  Eigen::MatrixXd both(rows, 2);  // columns: shape and velocity
  std::vector<std::size_t> blocks;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    if (!used[i]) continue;
    const auto row = static_cast<Eigen::Index>(blocks.size());
    for (Eigen::Index k = 0; k < unknowns; ++k) other(row, k) = equations[i].other[static_cast<std::size_t>(k)];
    both(row, 0) = equations[i].shape;
    both(row, 1) = equations[i].velocity;
    blocks.push_back(equations[i].block);
  }
  const Eigen::MatrixXd rest = both - other * other.colPivHouseholderQr().solve(both);
  const Eigen::VectorXd shape = rest.col(0), velocity = rest.col(1);
  const double square = velocity.squaredNorm();
  if (square < 1e-9 * static_cast<double>(rows)) return std::nullopt;
  const double t = velocity.dot(shape) / square;
  const Eigen::VectorXd residual = shape - t * velocity;
  const double variance = std::max(residual.squaredNorm() / static_cast<double>(rows - unknowns - 1), 1e-18);
  std::map<std::size_t, double> scores;
  for (Eigen::Index i = 0; i < rows; ++i) {
    scores[blocks[static_cast<std::size_t>(i)]] += velocity(i) * residual(i) / variance;
  }
  if (scores.size() < kMinBlocks) return std::nullopt;
  Slope slope;
  slope.weight = square / variance;
  slope.moment = slope.weight * t;
  for (const auto& [block, score] : scores) slope.score_squares += score * score;
  slope.blocks = scores.size();
  slope.used = static_cast<std::size_t>(rows);
  return slope;
}

/// Regresses twice, the second time without outliers.
std::optional<Slope> robust_slope(std::vector<Equation> equations) {
  compare_within_cells(equations);
  std::vector<bool> used(equations.size(), true);
  std::optional<Slope> slope = regress(equations, used);
  if (!slope) return slope;
  // These residuals, about all unknowns, only serve to find outliers.
  const auto rows = static_cast<Eigen::Index>(equations.size());
  const auto unknowns = static_cast<Eigen::Index>(equations[0].other.size());
  Eigen::MatrixXd all(rows, unknowns + 1);
  Eigen::VectorXd shape(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Equation& equation = equations[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < unknowns; ++k) all(i, k) = equation.other[static_cast<std::size_t>(k)];
    all(i, unknowns) = equation.velocity;
    shape(i) = equation.shape;
  }
  const Eigen::VectorXd residual = shape - all * all.colPivHouseholderQr().solve(shape);
  std::vector<double> magnitudes;
  for (Eigen::Index i = 0; i < rows; ++i) magnitudes.push_back(std::abs(residual(i)));
  // 1.4826 times the median is the standard deviation of a normal distribution.
  const double limit = kOutlier * 1.4826 * statistics::median(magnitudes);
  for (Eigen::Index i = 0; i < rows; ++i) used[static_cast<std::size_t>(i)] = std::abs(residual(i)) <= limit;
  std::optional<Slope> without = regress(equations, used);
  return without ? without : slope;
}

struct Motion {
  double vx = 0.0, vy = 0.0, ax = 0.0, ay = 0.0;
};

}  // namespace

ReadoutMeasurement::ReadoutMeasurement(std::size_t rows, double period_s)
    : rows_(rows), block_frames_(std::max<std::size_t>(5, static_cast<std::size_t>(0.5 / period_s))) {}

bool ReadoutMeasurement::belongs(const Track& track, const Sample& sample) const {
  const Sample& last = track.back();
  const std::uint32_t gap = sample.number - last.number;
  if (gap > 2 * block_frames_) return false;
  const bool is_near_in_time = gap <= kLargestStep;
  double x = last.object.x, y = last.object.y;
  if (is_near_in_time && track.size() > 1) {
    const Sample& before = track[track.size() - 2];
    const double factor = static_cast<double>(gap) / static_cast<double>(last.number - before.number);
    x += factor * (last.object.x - before.object.x);
    y += factor * (last.object.y - before.object.y);
  }
  const double side = std::sqrt(last.object.area), ratio = sample.object.area / last.object.area;
  // After a pause of the program, the object may be up to twice its size away.
  const double reach = (is_near_in_time ? 0.5 : 2.0) * side;
  return std::hypot(sample.object.x - x, sample.object.y - y) < reach && ratio > 0.7 && ratio < 1.4;
}

bool ReadoutMeasurement::is_evenly_spaced(const Track& track, std::size_t middle, std::uint32_t step) {
  for (std::size_t i = middle - kReach; i < middle + kReach; ++i) {
    if (track[i + 1].number - track[i].number != step) return false;
  }
  return true;
}

void ReadoutMeasurement::add(std::uint32_t number, const std::vector<MovingObject>& objects) {
  for (const MovingObject& object : objects) {
    const Sample sample{number, object};
    Track* nearest = nullptr;
    for (Track& track : tracks_) {
      if (track.back().number != number && belongs(track, sample)) nearest = &track;
    }
    if (nearest == nullptr) nearest = &tracks_.emplace_back();
    nearest->push_back(sample);
  }
  // Tracks that have ended and are too short are never used.
  std::erase_if(tracks_, [&](const Track& track) {
    return track.size() < kMinSamples && number - track.back().number > 2 * block_frames_;
  });
}

ReadoutEstimate ReadoutMeasurement::estimate() const {
  const auto rows = static_cast<double>(rows_);
  double t = 0.0;  // time between two rows
  Slope sum;
  // The first pass assumes no motion during the readout; the second and third know it.
  for (int pass = 0; pass < 3; ++pass) {
    sum = {};
    for (const Track& track : tracks_) {
      std::vector<Equation> leans, heights;
      for (std::size_t i = kReach; i + kReach < track.size(); ++i) {
        const std::uint32_t step = track[i].number - track[i - 1].number;
        if (step > kLargestStep || !is_evenly_spaced(track, i, step)) continue;
        const auto at = [&](int offset) -> const MovingObject& {
          return track[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + offset)].object;
        };
        const auto speed = [&](double MovingObject::*of) {
          return (at(-2).*of - 8.0 * at(-1).*of + 8.0 * at(1).*of - at(2).*of) / (12.0 * step);
        };
        const auto acceleration = [&](double MovingObject::*of) { return at(-1).*of - 2.0 * at(0).*of + at(1).*of; };
        const MovingObject& object = at(0);
        Motion motion{speed(&MovingObject::x), speed(&MovingObject::y), acceleration(&MovingObject::x),
                      acceleration(&MovingObject::y)};
        // The centroid is seen at the time of its row, so the apparent speed is too high by this factor.
        const double stretch = 1.0 + t * motion.vy;
        motion.vx /= stretch;
        const double x = object.x / rows - 0.5, y = object.y / rows - 0.5;
        const std::vector<double> place{1.0, x, y, x * x, x * y, y * y};
        const std::size_t block = track[i].number / block_frames_;
        const auto cell =
            static_cast<std::uint64_t>(object.x / kCell) << 32U | static_cast<std::uint64_t>(object.y / kCell);
        if (!object.cut_at_side) {
          Equation lean{object.lean, motion.vx, place, block, cell};
          lean.other.push_back(motion.ax);
          lean.other.push_back(motion.vx * motion.vy);  // effect of motion blur
          leans.push_back(std::move(lean));
        }
        if (!object.cut_at_side && !object.cut_at_end) {
          // The height changes by log(1 + t v), where v is the apparent speed; its nonlinear part is known from the
          // previous pass.
          Equation height{object.log_height - (std::log(std::max(stretch, 0.1)) - t * motion.vy), motion.vy, place,
                          block, cell};
          height.other.push_back(motion.ay);
          height.other.push_back(motion.vy * motion.vy);  // effect of motion blur
          heights.push_back(std::move(height));
        }
      }
      for (const std::vector<Equation>& equations : {leans, heights}) {
        if (equations.size() < kMinSamples) continue;
        const std::optional<Slope> slope = robust_slope(equations);
        if (!slope) continue;
        sum.weight += slope->weight;
        sum.moment += slope->moment;
        sum.score_squares += slope->score_squares;
        sum.used += slope->used;
        sum.blocks += slope->blocks;
      }
    }
    if (sum.weight <= 0.0) return {};
    t = sum.moment / sum.weight;
  }
  ReadoutEstimate estimate;
  estimate.known = true;
  estimate.readout = t * (rows - 1.0);
  const auto blocks = static_cast<double>(sum.blocks);
  // With few blocks the variance is underestimated; the usual factor for a small number of clusters corrects it.
  const double variance = sum.score_squares / (sum.weight * sum.weight) * blocks / (blocks - 1.0);
  estimate.sigma = std::sqrt(variance) * (rows - 1.0);
  estimate.motion_frames = static_cast<double>(sum.used);
  return estimate;
}

}  // namespace touchline::devices
