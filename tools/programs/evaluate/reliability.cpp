#include "tools/programs/evaluate/reliability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchline::evaluate {

void Reliability::add(std::optional<double> confidence, bool right) {
  if (!confidence.has_value()) return;
  const auto bin = std::find_if(bins_.begin(), bins_.end() - 1, [&](const Bin& b) { return *confidence < b.high; });
  ++bin->count;
  bin->right += right ? 1u : 0u;
  bin->confidence_sum += *confidence;
}

void Reliability::add(const Reliability& other) {
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    bins_[i].count += other.bins_[i].count;
    bins_[i].right += other.bins_[i].right;
    bins_[i].confidence_sum += other.bins_[i].confidence_sum;
  }
}

std::size_t Reliability::count() const {
  return std::accumulate(bins_.begin(), bins_.end(), std::size_t{0},
                         [](std::size_t sum, const Bin& bin) { return sum + bin.count; });
}

double Reliability::calibration_error() const {
  if (count() == 0) return 0.0;
  double sum = 0.0;
  for (const Bin& bin : bins_) sum += std::abs(bin.confidence_sum - static_cast<double>(bin.right));
  return sum / static_cast<double>(count());
}

void ReliabilityOfScene::add(const ReliabilityOfScene& other) {
  named.add(other.named);
  unnamed.add(other.unnamed);
  ball.add(other.ball);
}

Reliability ReliabilityOfScene::all() const {
  Reliability sum = named;
  sum.add(unnamed);
  sum.add(ball);
  return sum;
}

}  // namespace touchline::evaluate
