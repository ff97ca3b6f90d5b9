#include "tools/programs/calibrate/colors/marker_search.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "tools/programs/calibrate/colors/layout_sampling.h"

namespace touchline::calibrate {
namespace {

using Point = std::complex<double>;

class Search {
 public:
  Search(const std::vector<FoundPatch>& patches, const std::vector<std::size_t>& numbers, const MarkerLayout& layout,
         const CameraModel& camera)
      : layout_(layout), numbers_(numbers) {
    fits_.resize(layout.patches.size());
    for (const std::size_t number : numbers) {
      const FoundPatch& patch = patches[number];
      const FieldPoint at = camera.to_field(patch.center, layout.height_m);
      points_.emplace_back(static_cast<double>(at.x_m), static_cast<double>(at.y_m));
      tolerance_m_.push_back(kLayoutError_m +
                             kCenterError_px / static_cast<double>(camera.scale_px_per_m(at, layout.height_m)));
      for (std::size_t place = 0; place < layout.patches.size(); ++place) {
        const double relative = relative_area(patch, camera, size_of(layout.patches[place], layout));
        fits_[place].push_back(relative >= kMinRelativeArea && relative <= kMaxRelativeArea);
      }
    }
  }

  std::vector<MarkerCandidate> run() {
    for (std::size_t team = 0; team < points_.size(); ++team) {
      if (!fits_[0][team]) continue;
      chosen_ = {team};
      extend();
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] Point place(std::size_t i) const {
    return {static_cast<double>(layout_.patches[i].x_m), static_cast<double>(layout_.patches[i].y_m)};
  }

  // Tries each fitting patch at the next position: its distances to all earlier patches must match the layout.
  void extend() {
    const std::size_t next = chosen_.size();
    if (next == layout_.patches.size()) {
      accept();
      return;
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!fits_[next][i] || std::find(chosen_.begin(), chosen_.end(), i) != chosen_.end()) continue;
      bool right = true;
      for (std::size_t k = 0; right && k < next; ++k) {
        const double distance = std::abs(points_[i] - points_[chosen_[k]]);
        right = std::abs(distance - std::abs(place(next) - place(k))) <= tolerance_m_[i];
      }
      if (!right) continue;
      chosen_.push_back(i);
      extend();
      chosen_.pop_back();
    }
  }

  // A mirrored layout matches in its distances, too; only a rigid fit detects it.
  void accept() {
    std::vector<Point> places;
    double tolerance = 0;
    MarkerCandidate marker;
    for (const std::size_t chosen : chosen_) {
      places.push_back(points_[chosen]);
      tolerance = std::max(tolerance, tolerance_m_[chosen]);
      marker.patches.push_back(numbers_[chosen]);
    }
    marker.residual_m = fit_layout(layout_, places).residual_m;
    if (marker.residual_m <= tolerance) found_.push_back(std::move(marker));
  }

  const MarkerLayout& layout_;
  const std::vector<std::size_t>& numbers_;
  std::vector<Point> points_;
  std::vector<double> tolerance_m_;
  std::vector<std::vector<bool>> fits_;  // indexed by position and patch
  std::vector<std::size_t> chosen_;
  std::vector<MarkerCandidate> found_;
};

}  // namespace

std::vector<MarkerCandidate> find_markers(const std::vector<FoundPatch>& patches,
                                          const std::vector<std::size_t>& numbers, const MarkerLayout& layout,
                                          const CameraModel& camera) {
  return Search(patches, numbers, layout, camera).run();
}

}  // namespace touchline::calibrate
