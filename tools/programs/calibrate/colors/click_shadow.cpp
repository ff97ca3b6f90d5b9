#include "tools/programs/calibrate/colors/click_shadow.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "tools/programs/calibrate/colors/click_matching.h"
#include "tools/programs/calibrate/imaging/channel_image.h"
#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {
namespace {

constexpr double kShadowedLight = 0.5, kPictureGamma = 2.2;
// Half the side of the square around a click whose median stands for the floor, relative to the picture's width: 32 of
// 640 pixels, so that a robot covers less than half of the square.
constexpr double kReachOfFloor = 0.05;
// Reads every n-th pixel in each direction.
constexpr int kFloorStep = 2;

// Returns the brightness of a pixel above black.
int brightness_of(const Channels& value, ColorSpace space) {
  if (is_yuv(space)) return std::max(0, value[0] - black_value(space, 0));
  return (value[0] + 2 * value[1] + value[2]) / 4;
}

// Returns the median brightness of the pixels inside a rectangle; empty if there are none.
std::optional<double> median_brightness(const ChannelImage& image, const std::vector<std::uint8_t>& inside, int left,
                                        int top, int right, int bottom) {
  std::vector<int> values;
  for (int v = std::max(0, top); v < std::min(image.height_px, bottom); v += kFloorStep) {
    for (int u = std::max(0, left); u < std::min(image.width_px, right); u += kFloorStep) {
      if (inside[image.index(u, v)] != 0) values.push_back(brightness_of(image.at(u, v), image.space));
    }
  }
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Result<std::vector<ShadowedClick>> clicks_in_shadow(const std::vector<Click>& clicks,
                                                    const std::map<std::string, CameraPicture>& pictures,
                                                    const LightMap& light, const Polygon& region_of_interest) {
  std::vector<ShadowedClick> out;
  for (const auto& [name, picture] : pictures) {
    const auto is_here = [&name = name](const Click& click) { return click.image == name; };
    if (std::none_of(clicks.begin(), clicks.end(), is_here)) continue;
    const Frame frame = picture.frame();
    const auto shading = std::make_unique<Shading>();
    if (light.columns > 0) {
      if (Status s = shading->build(light, frame.width_px, frame.height_px, color_space(frame.format)); !s.ok()) {
        return Error{ErrorCode::kInconsistent, name + ": the light map does not fit the picture"};
      }
    }
    const ChannelImage image = corrected_channels(frame, *shading);
    const std::vector<std::uint8_t> inside = inside_mask(region_of_interest, image.width_px, image.height_px);
    const double usual = median_brightness(image, inside, 0, 0, image.width_px, image.height_px).value_or(0.0);
    if (usual <= 0) continue;
    const int reach = static_cast<int>(kReachOfFloor * image.width_px);
    for (std::size_t i = 0; i < clicks.size(); ++i) {
      if (!is_here(clicks[i])) continue;
      const int u = static_cast<int>(clicks[i].u_px), v = static_cast<int>(clicks[i].v_px);
      const std::optional<double> floor = median_brightness(image, inside, u - reach, v - reach, u + reach, v + reach);
      // If a click is outside the picture or its region of interest, this is reported when the click is used.
      if (!floor) continue;
      const double share = std::pow(*floor / usual, kPictureGamma);
      if (share < kShadowedLight) out.push_back({i, share});
    }
  }
  std::sort(out.begin(), out.end(), [](const ShadowedClick& a, const ShadowedClick& b) { return a.number < b.number; });
  return out;
}

std::string describe_shadow(const ShadowedClick& shadowed, const std::vector<Click>& clicks, bool has_light_map) {
  return formatted(
      "click %s is in shadow: the floor around has %.0f %% of the light of most of the field. Click on a patch in the "
      "light, %s",
      describe_click(shadowed.number, clicks[shadowed.number]).c_str(), 100 * shadowed.light,
      has_light_map ? "or renew the light map (touchline-calibrate light) if this shadow stays"
                    : "or make a light map first (touchline-calibrate light)");
}

}  // namespace touchline::calibrate
