#include "tools/programs/calibrate/colors/layout_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/programs/statistics/statistics.h"

namespace touchline::calibrate {
namespace {

using PlanePoint = std::complex<double>;

// A long axis gives the heading if its variance exceeds that of the other axis by this factor.
constexpr double kLongAxis = 1.5;
// Part of an outline's length and width that is sampled; chroma bleeds over the rest.
constexpr double kInnerPart = 0.6;
constexpr std::size_t kMinPixels = 4;
// Pixels within this distance of the median have the color of the sample.
constexpr double kSameColor = 30.0;
// A dark patch is no shadow if its contrast and its saturation are at least this large.
constexpr double kMinContrast = 8.0, kMinSaturation = 0.25;

FieldPoint field_point(PlanePoint at) { return {static_cast<float>(at.real()), static_cast<float>(at.imag())}; }

// Returns whether a point in the patch's coordinates lies in the inner part of the outline.
bool in_inner_part(const PatchPlace& place, PlanePoint at) {
  const double length = static_cast<double>(place.length_m) * kInnerPart;
  const double width = static_cast<double>(place.width_m) * kInnerPart;
  switch (place.outline) {
    case PatchOutline::kCircle:
      return std::abs(at) <= length / 2;
    case PatchOutline::kTriangle:  // The centroid of a triangle is a third of the height above the base.
      return at.real() >= -length / 3 && std::abs(at.imag()) <= width / 2 * (2 * length / 3 - at.real()) / length;
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      break;
  }
  return std::abs(at.real()) <= length / 2 && std::abs(at.imag()) <= width / 2;
}

}  // namespace

PlanePoint place_of(const PatchPlace& place) {
  return {static_cast<double>(place.x_m), static_cast<double>(place.y_m)};
}

PlanePoint LayoutView::on_field(PixelPoint pixel) const {
  const FieldPoint at = camera.to_field(pixel, layout.height_m);
  return {static_cast<double>(at.x_m), static_cast<double>(at.y_m)};
}

double LayoutView::tolerance_m(PlanePoint at) const {
  return kLayoutError_m +
         kCenterError_px / static_cast<double>(camera.scale_px_per_m(field_point(at), layout.height_m));
}

bool LayoutView::fits(const FoundPatch& patch, std::size_t place) const {
  const double relative = relative_area(patch, camera, size_of(layout.patches[place], layout));
  return relative >= kMinRelativeArea && relative <= kMaxRelativeArea;
}

std::vector<double> LayoutView::headings(const std::vector<FoundPatch>& patches,
                                         const std::vector<std::size_t>& numbers, std::size_t team) const {
  std::vector<double> out;
  const PatchPlace& place = layout.patches[0];
  const PrincipalVariances expected = principal_variances(place);
  const PlanePoint center = on_field(patches[team].center);
  if (static_cast<double>(expected.major_m2) > kLongAxis * static_cast<double>(expected.minor_m2)) {
    PlanePoint sum = 0;  // direction with twice the angle of the long axis
    const auto width = static_cast<std::size_t>(picture.image.width_px);
    for (const std::size_t pixel : patches[team].pixels) {
      const std::size_t row = pixel / width, column = pixel % width;
      const PlanePoint arm = on_field({static_cast<float>(column), static_cast<float>(row)}) - center;
      sum += arm * arm;
    }
    const double heading = std::arg(sum) / 2 - static_cast<double>(expected.axis_rad);
    out = {heading, heading + std::numbers::pi};
  }
  for (const std::size_t other : numbers) {
    if (other == team) continue;
    const PlanePoint arm = on_field(patches[other].center) - center;
    for (std::size_t k = 1; k < layout.patches.size(); ++k) {
      const PlanePoint wanted = place_of(layout.patches[k]) - place_of(place);
      if (fits(patches[other], k) && std::abs(std::abs(arm) - std::abs(wanted)) <= tolerance_m(center))
        out.push_back(std::arg(arm / wanted));
    }
  }
  return out;
}

LayoutFit fit_layout(const MarkerLayout& layout, const std::vector<PlanePoint>& places) {
  const auto count = static_cast<double>(places.size());
  PlanePoint mean = 0, layout_mean = 0, turn = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    mean += places[k] / count;
    layout_mean += place_of(layout.patches[k]) / count;
  }
  for (std::size_t k = 0; k < places.size(); ++k)
    turn += (places[k] - mean) * std::conj(place_of(layout.patches[k]) - layout_mean);
  LayoutFit out;
  if (std::abs(turn) > 0) out.turn = turn / std::abs(turn);
  out.center = mean - out.turn * layout_mean;
  double sum = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    sum += std::norm(places[k] - out.center - out.turn * place_of(layout.patches[k]));
  out.residual_m = std::sqrt(sum / count);
  return out;
}

std::optional<PlaceSample> sample_place(const LayoutView& view, std::size_t place, PlanePoint at, PlanePoint turn) {
  const PatchPlace& shape = view.layout.patches[place];
  const ChannelImage& image = view.picture.image;
  const FieldPoint point = field_point(at);
  const double scale = static_cast<double>(view.camera.scale_px_per_m(point, view.layout.height_m));
  const double extent = std::hypot(static_cast<double>(shape.length_m), static_cast<double>(shape.width_m));
  PlaceSample out;
  out.middle = view.camera.to_pixel(point, view.layout.height_m);
  out.radius_px = std::clamp(static_cast<int>(std::ceil(extent * scale / 2)), 1, 100);
  const int u0 = static_cast<int>(std::lround(out.middle.u_px)), v0 = static_cast<int>(std::lround(out.middle.v_px));
  if (!image.contains(u0, v0) || view.picture.inside[image.index(u0, v0)] == 0) return std::nullopt;
  const PlanePoint own_turn = turn * std::polar(1.0, static_cast<double>(shape.turn_rad));
  std::array<std::vector<std::uint8_t>, 3> values;
  for (int v = v0 - out.radius_px; v <= v0 + out.radius_px; ++v) {
    for (int u = u0 - out.radius_px; u <= u0 + out.radius_px; ++u) {
      if (!image.contains(u, v)) continue;
      const PlanePoint arm = view.on_field({static_cast<float>(u), static_cast<float>(v)}) - at;
      if (!in_inner_part(shape, arm / own_turn)) continue;
      out.pixels.push_back(image.index(u, v));
      for (std::size_t c = 0; c < 3; ++c) values[c].push_back(image.at(u, v)[c]);
    }
  }
  if (out.pixels.size() < kMinPixels) return std::nullopt;
  for (std::size_t c = 0; c < 3; ++c) out.median[c] = statistics::median(values[c]);
  const auto even = std::count_if(out.pixels.begin(), out.pixels.end(), [&](std::size_t pixel) {
    return color_distance(image.pixels[pixel], out.median, image.space) <= kSameColor;
  });
  out.even = static_cast<double>(even) / static_cast<double>(out.pixels.size());
  const Channels& floor = view.picture.floor.at(u0, v0);
  out.contrast = color_distance(out.median, floor, image.space);
  const Channels shown = to_rgb8(out.median, image.space);
  const bool colored =
      out.contrast >= kMinContrast && saturation({static_cast<double>(shown[0]), static_cast<double>(shown[1]),
                                                  static_cast<double>(shown[2])}) >= kMinSaturation;
  out.on_top = colored || differs_from_floor(out.median, floor, image.space);
  return out;
}

FoundPatch sampled_patch(const ChannelImage& image, PlaceSample sample) {
  GrownPatch region;
  region.pixels = std::move(sample.pixels);
  FoundPatch patch = patch_of(image, sample.middle, sample.radius_px, std::move(region));
  patch.sampled = true;
  return patch;
}

}  // namespace touchline::calibrate
