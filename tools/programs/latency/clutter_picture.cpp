#include "tools/programs/latency/clutter_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "core/geometry/camera_model.h"
#include "core/marker/rigid_fit.h"

namespace touchline::latency {
namespace {

constexpr std::array kClutterNumbers{ClutterNumber{"robots", &ClutterRecipe::robots, 0, 40},
                                     ClutterNumber{"spacing", &ClutterRecipe::spacing_percent, 30, 300},
                                     ClutterNumber{"covered", &ClutterRecipe::covered_percent, 0, 100},
                                     ClutterNumber{"heap", &ClutterRecipe::heap, 0, 4000},
                                     ClutterNumber{"patch", &ClutterRecipe::patch_percent, 10, 400},
                                     ClutterNumber{"aspect", &ClutterRecipe::aspect_percent, 20, 100},
                                     ClutterNumber{"spread", &ClutterRecipe::spread_percent, 5, 100},
                                     ClutterNumber{"colors", &ClutterRecipe::colors, 1, 32},
                                     ClutterNumber{"team", &ClutterRecipe::team_percent, 0, 100},
                                     ClutterNumber{"balls", &ClutterRecipe::balls, 0, 100},
                                     ClutterNumber{"ball", &ClutterRecipe::ball_percent, 20, 400},
                                     ClutterNumber{"noise", &ClutterRecipe::noise_per_mille, 0, 1000},
                                     ClutterNumber{"run", &ClutterRecipe::noise_run, 1, 40},
                                     ClutterNumber{"blur", &ClutterRecipe::blur, 0, 8},
                                     ClutterNumber{"seed", &ClutterRecipe::seed, 1, 1000000}};

constexpr PixelValue kBlackValue{16, 128, 128};

class ClutterPainter {
 public:
  ClutterPainter(const ClutterRecipe& recipe, const PipelineParameters& parameters, const CameraModel& camera,
                 const PixelValue& background)
      : recipe_(recipe),
        parameters_(parameters),
        camera_(camera),
        width_(parameters.scan.width_px),
        height_(parameters.scan.height_px),
        random_(static_cast<std::uint32_t>(recipe.seed)),
        picture_(std::size_t{parameters.scan.width_px} * parameters.scan.height_px, background) {
    const bool is_rgb = color_space(parameters.scan.format) == ColorSpace::kRgb;
    black_ = is_rgb ? PixelValue{20, 20, 20} : kBlackValue;
    for (const ColorBox& box : parameters.scan.boxes) {
      if (std::find(colors_.begin(), colors_.end(), box.color) == colors_.end()) colors_.push_back(box.color);
    }
  }

  std::vector<PixelValue> paint() {
    paint_noise();
    paint_heap();
    for (int i = 0; i < recipe_.robots; ++i) paint_robot(i);
    paint_balls();
    for (int pass = 0; pass < 2 && recipe_.blur > 0; ++pass) blur(pass == 0 ? 1 : width_);
    return std::move(picture_);
  }

 private:
  // Returns a uniform number in [low, high). (It avoids the standard distributions, which differ between libraries.)
  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8u) / 16777216.0f;
  }
  std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  [[nodiscard]] PixelValue value_of(ColorId color) const {
    if (parameters_.adaptation.typical.measured[color]) return parameters_.adaptation.typical[color];
    PixelValue middle = black_;
    for (const ColorBox& box : parameters_.scan.boxes) {
      if (box.color != color) continue;
      for (std::size_t c = 0; c < 3; ++c) middle[c] = static_cast<std::uint8_t>((box.low[c] + box.high[c]) / 2);
      break;
    }
    return middle;
  }
  ColorId any_color() {
    const auto count = std::min(colors_.size(), static_cast<std::size_t>(recipe_.colors));
    return colors_.empty() ? kBackground : colors_[below(count)];
  }

  void set(int u, int v, const PixelValue& value) {
    if (u >= 0 && v >= 0 && u < width_ && v < height_)
      picture_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u)] = value;
  }

  void paint_noise() {
    for (int v = 0; v < height_ && recipe_.noise_per_mille > 0; ++v) {
      for (int u = 0; u < width_; u += recipe_.noise_run) {
        if (below(1000) >= static_cast<std::size_t>(recipe_.noise_per_mille)) continue;
        const PixelValue value = value_of(any_color());
        for (int k = 0; k < recipe_.noise_run && u + k < width_; ++k) set(u + k, v, value);
      }
    }
  }

  // Paints a rotated rectangle, or a disk if `round`.
  void paint_shape(PixelPoint center, float length, float width, float angle, bool round, const PixelValue& value) {
    const float c = std::cos(angle), s = std::sin(angle), reach = 0.5f * std::hypot(length, width) + 1.0f;
    const int left = static_cast<int>(center.u_px - reach), right = static_cast<int>(center.u_px + reach);
    const int top = static_cast<int>(center.v_px - reach), bottom = static_cast<int>(center.v_px + reach);
    for (int v = std::max(top, 0); v <= std::min(bottom, height_ - 1); ++v) {
      for (int u = std::max(left, 0); u <= std::min(right, width_ - 1); ++u) {
        const float du = static_cast<float>(u) - center.u_px, dv = static_cast<float>(v) - center.v_px;
        const float along = c * du + s * dv, across = c * dv - s * du;
        const bool inside = round ? std::hypot(along, across) < 0.5f * length
                                  : std::abs(along) < 0.5f * length && std::abs(across) < 0.5f * width;
        if (inside) set(u, v, value);
      }
    }
  }

  [[nodiscard]] const TeamMarking& team(std::size_t number) const { return parameters_.marker.teams[number % 2]; }
  [[nodiscard]] float scale() const { return camera_.scale_px_per_m({}, team(0).layout.height_m); }

  PixelPoint place_in_heap() {
    const float share = 0.5f * static_cast<float>(recipe_.spread_percent) / 100.0f;
    const float u = between(0.5f - share, 0.5f + share), v = between(0.5f - share, 0.5f + share);
    return {u * static_cast<float>(width_), v * static_cast<float>(height_)};
  }

  void paint_heap() {
    const auto& patches = team(0).layout.patches;
    if (patches.empty()) return;
    const float length = std::sqrt(area_m2(patches[0])) * scale() * static_cast<float>(recipe_.patch_percent) / 100.0f;
    const float width = length * static_cast<float>(recipe_.aspect_percent) / 100.0f;
    for (int i = 0; i < recipe_.heap; ++i) {
      const PixelPoint center = place_in_heap();
      const float angle = between(0.0f, std::numbers::pi_v<float>);
      const bool of_team = below(100) < static_cast<std::size_t>(recipe_.team_percent);
      const ColorId color = of_team ? team(below(2)).team_color : any_color();
      paint_shape(center, length, width, angle, false, value_of(color));
    }
  }

  void paint_robot(int number) {
    const TeamMarking& marking = team(static_cast<std::size_t>(number));
    if (marking.layout.patches.empty()) return;
    const float pitch = marking.layout.robot_side_m * static_cast<float>(recipe_.spacing_percent) / 100.0f;
    const int columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(recipe_.robots))));
    const float middle = 0.5f * static_cast<float>(columns - 1);
    const int row = number / columns, column = number % columns;
    const Pose pose{{(static_cast<float>(column) - middle) * pitch, (static_cast<float>(row) - middle) * pitch},
                    between(-std::numbers::pi_v<float>, std::numbers::pi_v<float>)};
    const float half = 0.5f * marking.layout.robot_side_m;
    paint_on_robot(pose, marking, {.length_m = 2 * half, .width_m = 2 * half}, black_);
    const auto robot = static_cast<std::size_t>(number / 2);
    for (std::size_t k = 0; k < marking.layout.patches.size(); ++k) {
      const ColorId color = k == 0                   ? marking.team_color
                            : marking.robots.empty() ? any_color()
                                                     : marking.robots[robot % marking.robots.size()].colors[k - 1];
      paint_on_robot(pose, marking, marking.layout.patches[k], value_of(color));
    }
    if (below(100) < static_cast<std::size_t>(recipe_.covered_percent)) {
      const PatchPlace bar{.x_m = between(-half, half), .length_m = 0.4f * half, .width_m = 2 * half};
      paint_on_robot(pose, marking, bar, black_);
    }
  }

  void paint_on_robot(const Pose& pose, const TeamMarking& marking, const PatchPlace& place, const PixelValue& value) {
    const float c = std::cos(pose.theta_rad), s = std::sin(pose.theta_rad);
    const FieldPoint at{pose.position.x_m + c * place.x_m - s * place.y_m,
                        pose.position.y_m + s * place.x_m + c * place.y_m};
    const float height = marking.layout.height_m, factor = camera_.scale_px_per_m(at, height);
    const PixelPoint center = camera_.to_pixel(at, height);
    const PixelPoint ahead = camera_.to_pixel({at.x_m + 0.01f * c, at.y_m + 0.01f * s}, height);
    // This is exact enough for rotated squares, although the picture of a field may be mirrored against the robot's
    // frame.
    const float angle = std::atan2(ahead.v_px - center.v_px, ahead.u_px - center.u_px);
    paint_shape(center, place.length_m * factor, place.width_m * factor, angle, place.outline == PatchOutline::kCircle,
                value);
  }

  void paint_balls() {
    const BallParameters& ball = parameters_.marker.ball;
    if (ball.color == kBackground) return;
    const float diameter = 2.0f * ball.radius_m * scale() * static_cast<float>(recipe_.ball_percent) / 100.0f;
    for (int i = 0; i < recipe_.balls; ++i) {
      paint_shape(place_in_heap(), diameter, diameter, 0.0f, true, value_of(ball.color));
    }
  }

  // Replaces each pixel by the mean of 2 * blur + 1 pixels in one direction; at the ends of lines, the mean includes
  // pixels of the next line.
  void blur(int step) {
    const std::vector<PixelValue> sharp = picture_;
    const auto count = static_cast<int>(sharp.size());
    const int reach = recipe_.blur * step, first = reach, last = count - reach;
    std::array<int, 3> sum{};
    for (int line = 0; line < step; ++line) {
      sum = {};
      for (int i = first + line - reach; i <= std::min(first + line + reach, count - 1); i += step)
        add(sum, sharp, i, 1);
      for (int i = first + line; i < last; i += step) {
        for (std::size_t c = 0; c < 3; ++c) {
          picture_[static_cast<std::size_t>(i)][c] = static_cast<std::uint8_t>(sum[c] / (2 * recipe_.blur + 1));
        }
        add(sum, sharp, i - reach, -1);
        if (i + reach + step < count) add(sum, sharp, i + reach + step, 1);
      }
    }
  }
  static void add(std::array<int, 3>& sum, const std::vector<PixelValue>& from, int at, int factor) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += factor * from[static_cast<std::size_t>(at)][c];
  }

  const ClutterRecipe& recipe_;
  const PipelineParameters& parameters_;
  const CameraModel& camera_;
  int width_, height_;
  std::mt19937 random_;
  PixelValue black_{};
  std::vector<ColorId> colors_;
  std::vector<PixelValue> picture_;
};

}  // namespace

std::span<const ClutterNumber> clutter_numbers() { return kClutterNumbers; }

std::string text_of(const ClutterRecipe& recipe) {
  std::string text;
  for (const ClutterNumber& number : kClutterNumbers) {
    text += (text.empty() ? "" : " ") + std::string(number.name) + " " + std::to_string(recipe.*number.value);
  }
  return text;
}

std::optional<ClutterRecipe> clutter_recipe_of(const std::string& text) {
  std::istringstream in(text);
  ClutterRecipe recipe;
  for (const ClutterNumber& number : kClutterNumbers) {
    std::string name;
    int value = 0;
    if (!(in >> name >> value) || name != number.name || value < number.low || value > number.high) return {};
    recipe.*number.value = value;
  }
  std::string rest;
  return in >> rest ? std::nullopt : std::optional(recipe);
}

std::span<const NamedClutter> worst_clutter() {
  static constexpr std::array kWorst{
      NamedClutter{"heap of patches",
                   "robots 0 spacing 150 covered 0 heap 700 patch 90 aspect 100 spread 60 colors 13 team 25 balls 0 "
                   "ball 100 noise 0 run 1 blur 0 seed 1"},
      NamedClutter{"robots in large patches",
                   "robots 31 spacing 171 covered 46 heap 203 patch 188 aspect 91 spread 80 colors 11 team 5 balls 1 "
                   "ball 94 noise 110 run 18 blur 0 seed 780132"},
      NamedClutter{"robots in noise",
                   "robots 40 spacing 158 covered 12 heap 2711 patch 79 aspect 55 spread 12 colors 28 team 100 balls 0 "
                   "ball 72 noise 244 run 38 blur 1 seed 337971"},
      NamedClutter{"noise on large patches",
                   "robots 1 spacing 150 covered 67 heap 487 patch 249 aspect 100 spread 70 colors 22 team 31 balls 2 "
                   "ball 178 noise 571 run 15 blur 3 seed 435325"},
      NamedClutter{"crowd on patches",
                   "robots 38 spacing 55 covered 17 heap 2367 patch 126 aspect 63 spread 19 colors 11 team 62 balls 3 "
                   "ball 162 noise 287 run 1 blur 0 seed 17620"}};
  return kWorst;
}

std::vector<PixelValue> paint_clutter(const ClutterRecipe& recipe, const PipelineParameters& parameters,
                                      const CameraModel& camera, const PixelValue& background) {
  return ClutterPainter(recipe, parameters, camera, background).paint();
}

}  // namespace touchline::latency
