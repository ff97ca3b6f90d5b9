#include "tools/programs/calibrate/colors/marker_completion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <set>

namespace touchline::calibrate {
namespace {

using Point = std::complex<double>;

// Least share of the pixels that have the color of the patch.
constexpr double kEven = 0.7;
// Color difference to the floor above which a sample is certainly a patch.
constexpr double kClearlyDifferent = 100.0;

class Completion {
 public:
  Completion(std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers, const LayoutView& view)
      : patches_(patches), numbers_(numbers), view_(view) {}

  std::vector<MarkerCandidate> run() {
    for (const std::size_t team : numbers_) {
      if (!view_.fits(patches_[team], 0)) continue;
      for (const double heading : view_.headings(patches_, numbers_, team)) complete(team, heading);
    }
    return std::move(found_);
  }

 private:
  // Adds the marker with this team patch and heading if all of its identification patches can be found or sampled.
  void complete(std::size_t team, double heading) {
    const Point turn = std::polar(1.0, heading);
    const Point center = view_.on_field(patches_[team].center) - turn * place_of(view_.layout.patches[0]);
    MarkerCandidate marker;
    marker.patches = {team};
    marker.residual_m = 1.0;
    bool complete = true;
    for (std::size_t k = 1; k < view_.layout.patches.size(); ++k) {
      const Point at = center + turn * place_of(view_.layout.patches[k]);
      std::size_t patch = nearest(at, k, team);
      if (patch == kNoPatch) {
        complete = false;
        double contrast = 0;
        patch = sampled(at, turn, k, contrast);
        if (patch == kNoPatch) return;
        marker.residual_m += std::max(0.1, 1.0 - contrast / kClearlyDifferent);
      }
      marker.patches.push_back(patch);
    }
    if (!complete && known_.insert(marker.patches).second) found_.push_back(std::move(marker));
  }

  std::size_t nearest(Point at, std::size_t place, std::size_t team) const {
    std::size_t best = kNoPatch;
    double least = view_.tolerance_m(at);
    for (const std::size_t number : numbers_) {
      const double distance = std::abs(view_.on_field(patches_[number].center) - at);
      if (number == team || distance > least || !view_.fits(patches_[number], place)) continue;
      least = distance;
      best = number;
    }
    return best;
  }

  std::size_t sampled(Point at, Point turn, std::size_t place, double& contrast) {
    std::optional<PlaceSample> sample = sample_place(view_, place, at, turn);
    if (!sample || sample->even < kEven || !sample->on_top) return kNoPatch;
    contrast = sample->contrast;
    const int u = static_cast<int>(std::lround(sample->middle.u_px)),
              v = static_cast<int>(std::lround(sample->middle.v_px));
    const auto [entry, is_new] = sampled_.try_emplace({u, v, static_cast<int>(place)}, patches_.size());
    if (is_new) patches_.push_back(sampled_patch(view_.picture.image, std::move(*sample)));
    return entry->second;
  }

  static constexpr std::size_t kNoPatch = static_cast<std::size_t>(-1);

  std::vector<FoundPatch>& patches_;
  const std::vector<std::size_t>& numbers_;
  const LayoutView& view_;
  std::map<std::array<int, 3>, std::size_t> sampled_;  // sampled patches by pixel and place
  std::set<std::vector<std::size_t>> known_;
  std::vector<MarkerCandidate> found_;
};

}  // namespace

std::vector<MarkerCandidate> complete_markers(std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers,
                                              const LayoutView& view) {
  return Completion(patches, numbers, view).run();
}

}  // namespace touchline::calibrate
