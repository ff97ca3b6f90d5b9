#include "tools/programs/calibrate/field/edge_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace touchline::calibrate {
namespace {

constexpr double kToneExponent = 2.2;
// Spacing of the samples across a mark: a quarter of a pixel.
constexpr double kSampleStep_px = 0.25;
// Least contrast as a fraction of full scale. White paint reflects ten times as much light as a dark floor.
constexpr double kMinContrast = 0.04;
constexpr double kFlatRise = 0.35;
// Distance over which lens and interpolation blur an edge. Beyond it each side has its own level.
constexpr double kBlur_px = 2.0;
// Largest width of a line.
constexpr double kWidestLine_px = 14.0;
// Length of the piece on each side that gives the side's level, and largest variation of the level as a fraction of the
// edge's step. If another object is near, the level is undefined.
constexpr double kLevel_px = 1.5, kLevelVariation = 0.2;
// Largest distance of a refined edge from the crossing.
constexpr double kLargestCorrection_px = 0.5;

constexpr int kBlurSamples = static_cast<int>(kBlur_px / kSampleStep_px),
              kLevelSamples = static_cast<int>(kLevel_px / kSampleStep_px);

class Profile {
 public:
  Profile(const LightPicture& picture, double u, double v, double across_u, double across_v, double reach_px) {
    const auto half = static_cast<int>(std::ceil(reach_px / kSampleStep_px));
    origin_ = half;
    values_.reserve(std::size_t{2} * static_cast<std::size_t>(half) + 1);
    for (int i = -half; i <= half; ++i) {
      const double s = i * kSampleStep_px;
      double sum = 0;
      // Average along the mark, because the pattern of a Bayer filter repeats after two pixels.
      for (const double t : {-1.5, -0.5, 0.5, 1.5}) {
        sum += picture.at(u + s * across_u - t * across_v, v + s * across_v + t * across_u);
      }
      values_.push_back(sum / 4);
    }
  }

  [[nodiscard]] int size() const { return static_cast<int>(values_.size()); }
  [[nodiscard]] double operator[](int i) const { return values_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double place(double i) const { return (i - origin_) * kSampleStep_px; }

  // Returns the position between samples i and i + 1 at which the light crosses `level`.
  [[nodiscard]] double crossing(int i, double level) const {
    return place(i + (level - (*this)[i]) / ((*this)[i + 1] - (*this)[i]));
  }
  // Returns the smallest value of the samples [first, last].
  [[nodiscard]] double least(int first, int last) const {
    double value = (*this)[std::clamp(first, 0, size() - 1)];
    for (int i = std::max(first, 0); i <= std::min(last, size() - 1); ++i) value = std::min(value, (*this)[i]);
    return value;
  }
  // Returns the position of the edge near `crossing`, between a dark level before it and a bright level behind it. A
  // sharp edge at this position has the same sum of light (Lyvers et al. 1989, moments of an edge). By contrast, the
  // crossing of an interpolated level is wrong by up to a tenth of a pixel, depending on where the edge lies between
  // the pixels.
  [[nodiscard]] double edge_at(double crossing) const {
    const int middle = nearest(crossing), first = middle - kBlurSamples, last = middle + kBlurSamples;
    const std::optional<double> dark = level(first - kLevelSamples, first), bright = level(last, last + kLevelSamples);
    if (!dark || !bright || *bright <= *dark) return crossing;
    const double most = kLevelVariation * (*bright - *dark);
    if (variation(first - kLevelSamples, first) > most || variation(last, last + kLevelSamples) > most) return crossing;
    double area = 0.5 * ((*this)[first] + (*this)[last]) - *dark;
    for (int i = first + 1; i < last; ++i) area += (*this)[i] - *dark;
    const double place_of_edge = place(last) - kSampleStep_px * area / (*bright - *dark);
    return std::abs(place_of_edge - crossing) <= kLargestCorrection_px ? place_of_edge : crossing;
  }
  // Returns the middle of the line between two crossings: the center of its light above the level of both sides.
  [[nodiscard]] double line_at(double left, double right) const {
    const double crossing = 0.5 * (left + right);
    const int first = nearest(left) - kBlurSamples, last = nearest(right) + kBlurSamples;
    const std::optional<double> before = level(first - kLevelSamples, first), after = level(last, last + kLevelSamples);
    if (!before || !after) return crossing;
    double light = 0, moment = 0;
    for (int i = first; i <= last; ++i) {
      const double part = static_cast<double>(i - first) / (last - first);
      const double above = (*this)[i] - (*before + part * (*after - *before));
      light += above;
      moment += above * place(i);
    }
    const double most = kLevelVariation * greatest(first, last) - kLevelVariation * std::min(*before, *after);
    if (!(light > 0) || std::max(variation(first - kLevelSamples, first), variation(last, last + kLevelSamples)) > most)
      return crossing;
    const double center = moment / light;
    return std::abs(center - crossing) <= kLargestCorrection_px ? center : crossing;
  }

  [[nodiscard]] double greatest(int first, int last) const {
    double value = (*this)[std::clamp(first, 0, size() - 1)];
    for (int i = std::max(first, 0); i <= std::min(last, size() - 1); ++i) value = std::max(value, (*this)[i]);
    return value;
  }

 private:
  [[nodiscard]] int nearest(double place_px) const {
    return origin_ + static_cast<int>(std::lround(place_px / kSampleStep_px));
  }
  // Returns the mean of the samples [first, last]; empty if they exceed the profile.
  [[nodiscard]] std::optional<double> level(int first, int last) const {
    if (first < 0 || last >= size()) return std::nullopt;
    double sum = 0;
    for (int i = first; i <= last; ++i) sum += (*this)[i];
    return sum / (last - first + 1);
  }
  [[nodiscard]] double variation(int first, int last) const { return greatest(first, last) - least(first, last); }

  std::vector<double> values_;
  int origin_ = 0;
};

// Finds the steepest rise outwards, or the innermost rise that is nearly as steep: the side of a wall, which is darker
// than its top, begins at the edge of the floor.
std::optional<double> border_in(const Profile& profile, bool innermost) {
  const double flattest = innermost ? kFlatRise : 1.0;
  const auto rise_at = [&](int i) { return profile[i + 2] - profile[i - 2]; };
  double steepest_rise = 0;
  for (int i = 2; i + 2 < profile.size(); ++i) steepest_rise = std::max(steepest_rise, rise_at(i));
  int steepest = -1;
  for (int i = 2; i + 2 < profile.size(); ++i) {
    if (rise_at(i) < flattest * steepest_rise) continue;
    // Continue to the top of this rise.
    while (i + 3 < profile.size() && rise_at(i + 1) > rise_at(i)) ++i;
    steepest = i;
    break;
  }
  if (steepest < 2 * kBlurSamples || steepest + 2 * kBlurSamples >= profile.size()) return std::nullopt;
  const double dark = profile.least(steepest - 2 * kBlurSamples, steepest);
  const double bright = profile.greatest(steepest, steepest + 2 * kBlurSamples);
  if (bright - dark < kMinContrast) return std::nullopt;
  const double level = 0.5 * (bright + dark);
  int i = steepest;
  while (i > 0 && profile[i] > level) --i;
  while (i + 1 < profile.size() - 1 && profile[i + 1] <= level) ++i;
  if (profile[i] > level || profile[i + 1] <= level) return std::nullopt;
  return profile.edge_at(profile.crossing(i, level));
}

// Returns the middle between the two flanks of the brightest sample.
std::optional<double> line_in(const Profile& profile) {
  int top = 0;
  for (int i = 1; i < profile.size(); ++i) {
    if (profile[i] > profile[top]) top = i;
  }
  const int widest = static_cast<int>(kWidestLine_px / kSampleStep_px);
  const double dark = std::max(profile.least(top - widest, top), profile.least(top, top + widest));
  if (profile[top] - dark < kMinContrast) return std::nullopt;
  const double level = 0.5 * (profile[top] + dark);
  int left = top, right = top;
  while (left > 0 && profile[left] > level) --left;
  while (right < profile.size() - 1 && profile[right] > level) ++right;
  if (profile[left] > level || profile[right] > level || right - left > widest) return std::nullopt;
  return profile.line_at(profile.crossing(left, level), profile.crossing(right - 1, level));
}

PixelPoint seen(const CameraModel& camera, double x_m, double y_m) {
  return camera.to_pixel({static_cast<float>(x_m), static_cast<float>(y_m)}, 0.0f);
}

}  // namespace

LightPicture::LightPicture(const std::vector<hal::Picture>& pictures)
    : width_(static_cast<int>(pictures.at(0).width_px)), height_(static_cast<int>(pictures.at(0).height_px)) {
  std::array<float, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = static_cast<float>(std::pow(static_cast<double>(i) / 255.0, kToneExponent));
  }
  values_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (const hal::Picture& picture : pictures) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const std::uint8_t* rgb = &picture.rgb8[3 * i];
      values_[i] += (light[rgb[0]] + light[rgb[1]] + light[rgb[2]]) / (3.0f * static_cast<float>(pictures.size()));
    }
  }
}

double LightPicture::at(double u_px, double v_px) const {
  const double u = std::clamp(u_px, 0.0, static_cast<double>(width_ - 1));
  const double v = std::clamp(v_px, 0.0, static_cast<double>(height_ - 1));
  const int column = std::min(static_cast<int>(u), width_ - 2), row = std::min(static_cast<int>(v), height_ - 2);
  const double du = u - column, dv = v - row;
  const float* here =
      &values_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)];
  const float* below = here + width_;
  return (1 - dv) * ((1 - du) * static_cast<double>(here[0]) + du * static_cast<double>(here[1])) +
         dv * ((1 - du) * static_cast<double>(below[0]) + du * static_cast<double>(below[1]));
}

double length_of(const Mark& mark) {
  return mark.radius_m > 0 ? mark.radius_m * (mark.to_rad - mark.from_rad)
                           : std::hypot(mark.end_x_m - mark.begin_x_m, mark.end_y_m - mark.begin_y_m);
}

MarkPlace place_on(const Mark& mark, double way_m) {
  if (mark.radius_m > 0) {
    const double angle = mark.from_rad + way_m / mark.radius_m, c = std::cos(angle), s = std::sin(angle);
    return {mark.begin_x_m + mark.radius_m * c, mark.begin_y_m + mark.radius_m * s, -s, c};
  }
  const double length = length_of(mark);
  const double dx = (mark.end_x_m - mark.begin_x_m) / length, dy = (mark.end_y_m - mark.begin_y_m) / length;
  return {mark.begin_x_m + way_m * dx, mark.begin_y_m + way_m * dy, dx, dy};
}

std::vector<MarkPoint> find_marks(const LightPicture& picture, const CameraModel& camera,
                                  const std::vector<Mark>& marks, double step_px, double reach_px,
                                  std::vector<std::size_t>* tried_points) {
  std::vector<MarkPoint> points;
  if (tried_points != nullptr) tried_points->assign(marks.size(), 0);
  for (std::size_t m = 0; m < marks.size(); ++m) {
    const Mark& mark = marks[m];
    const double length = length_of(mark);
    const bool closed = mark.radius_m > 0 && length > mark.radius_m * 6.28;
    const double from = closed ? 0 : std::min(kMarkEnd_m, length / 4), to = length - from;
    const MarkPlace middle = place_on(mark, length / 2);
    const double scale = static_cast<double>(
        camera.scale_px_per_m({static_cast<float>(middle.x_m), static_cast<float>(middle.y_m)}, 0.0f));
    // Limit the count, because during the search the camera can project a mark anywhere.
    const int count = std::clamp(static_cast<int>(std::min((to - from) * scale / step_px, 4000.0)), 2, 4000);
    for (int i = 0; i <= count; ++i) {
      if (tried_points != nullptr) ++(*tried_points)[m];
      const MarkPlace place = place_on(mark, from + (to - from) * i / count);
      const PixelPoint at = seen(camera, place.x_m, place.y_m);
      // Project a second point, one centimeter to the right of the mark.
      const PixelPoint aside = seen(camera, place.x_m + 0.01 * place.along_y, place.y_m - 0.01 * place.along_x);
      const double u = static_cast<double>(at.u_px), v = static_cast<double>(at.v_px);
      double across_u = static_cast<double>(aside.u_px) - u, across_v = static_cast<double>(aside.v_px) - v;
      const double norm = std::hypot(across_u, across_v);
      if (norm <= 0 || u < 1 || v < 1 || u > picture.width_px() - 2 || v > picture.height_px() - 2) {
        continue;
      }
      across_u /= norm;
      across_v /= norm;
      const Profile profile(picture, u, v, across_u, across_v, reach_px);
      const auto found = mark.kind == MarkKind::kBorder ? border_in(profile, mark.innermost) : line_in(profile);
      if (!found) continue;
      points.push_back({m, place.x_m, place.y_m, u + *found * across_u, v + *found * across_v, across_u, across_v});
    }
  }
  return points;
}

}  // namespace touchline::calibrate
