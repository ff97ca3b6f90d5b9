#include "core/subpixel/paint_colors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/marker/identifier_scene.h"
#include "core/subpixel/blurred_outline.h"

namespace touchline {
namespace {

// 256 samples: on the smallest robots about one for each pixel.
constexpr int kGrid = 16;
// Pixels nearer to an edge show two surfaces: half of a usual lens's blur (EdgeWidth) and half a pixel. Where two
// pixels share chroma, almost one more.
constexpr float kPureFrom_px = 1.2f, kPureChromaFrom_px = 2.0f;
// The mean of fewer samples would be that of a corner.
constexpr float kMinSamples = 4;
// A channel is saturated if it is in more than this share of the samples. A choice, not tuned.
constexpr float kSaturatedShare = 0.25f;
// Prior for a uniform lamp, for each sample: 3 % of the variance of x over a whole top. Without it, terms that the
// visible surfaces leave open would be large.
constexpr float kUniform = 0.01f;
// Largest variation of light within surfaces that the lamp does not explain, relative to a patch's light: something
// covers a part. As kWorstUnevenness of top_fit.cpp.
constexpr float kMaxUnevenness = 0.30f;
constexpr float kCameraGamma = 2.2f;  // as in simd/linear_rgb.h

// x, y, x^2, xy, y^2 from the robot's center, in half sides.
constexpr int kLampTerms = 5;
using LampTerms = Eigen::Matrix<float, kLampTerms, 1>;
using LampEquations = Eigen::Matrix<float, kLampTerms, kLampTerms>;

float to_light(float value) { return std::pow(value / 255.0f, kCameraGamma); }
float to_value(float light) { return 255.0f * std::pow(std::max(0.0f, light), 1.0f / kCameraGamma); }

// Sums over the samples of one surface.
struct Surface {
  float count = 0;
  std::array<float, 3> light{}, saturated{};
  LampTerms terms = LampTerms::Zero();
  // Of the samples without a saturated channel; `gray` is the mean light of the channels.
  float clear = 0, gray = 0, gray_squares = 0;
  LampTerms clear_terms = LampTerms::Zero(), gray_terms = LampTerms::Zero();
  LampEquations squares = LampEquations::Zero();

  void add(const std::array<float, 3>& rgb, const LampTerms& at, float saturated_from) {
    count += 1;
    terms += at;
    bool is_clear = true;
    float mean = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float of_channel = to_light(rgb[c]);
      light[c] += of_channel;
      mean += of_channel / 3.0f;
      if (rgb[c] < saturated_from) continue;
      saturated[c] += 1;
      is_clear = false;
    }
    if (!is_clear) return;
    clear += 1;
    gray += mean;
    gray_squares += mean * mean;
    clear_terms += at;
    gray_terms += mean * at;
    squares += at * at.transpose();
  }
  [[nodiscard]] bool is_saturated(std::size_t channel) const { return saturated[channel] > kSaturatedShare * count; }
};

// The surfaces of a top: its patches, then what is free.
using Surfaces = FixedVector<Surface, kMaxPatches + 1>;

class TopSampler {
 public:
  TopSampler(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout, const Pose& pose)
      : frame_(frame), info_(info_of(frame.format)), layout_(layout), half_m_(0.5f * layout.robot_side_m) {
    const RobotOnField robot(pose);
    const auto pixel = [&](float x_m, float y_m) {
      PatchPlace place;
      place.x_m = x_m;
      place.y_m = y_m;
      return camera.to_pixel(robot(place), layout.height_m);
    };
    const PixelPoint front = pixel(half_m_, 0), left = pixel(0, half_m_);
    middle_ = pixel(0, 0);
    by_x_ = {front.u_px - middle_.u_px, front.v_px - middle_.v_px};
    by_y_ = {left.u_px - middle_.u_px, left.v_px - middle_.v_px};
    const float half_px = std::sqrt(std::abs(by_x_.u_px * by_y_.v_px - by_x_.v_px * by_y_.u_px));
    pure_m_ = (is_yuv(info_.space) ? kPureChromaFrom_px : kPureFrom_px) * half_m_ / half_px;
    for (const PatchPlace& place : layout.patches) outlines_.push_back(BlurredOutline(place));
  }

  void sample(float saturated_from, Surfaces& out) const {
    out.clear();
    out.resize(outlines_.size() + 1);
    for (int row = 0; row < kGrid; ++row) {
      for (int column = 0; column < kGrid; ++column) {
        const float x = (static_cast<float>(2 * column + 1) - kGrid) / kGrid;
        const float y = (static_cast<float>(2 * row + 1) - kGrid) / kGrid;
        std::size_t surface = 0;
        std::array<float, 3> rgb;
        if (!shows_one(x, y, surface) || !read(x, y, rgb)) continue;
        LampTerms terms;
        terms << x, y, x * x, x * y, y * y;
        out[surface].add(rgb, terms, saturated_from);
      }
    }
  }

 private:
  // Finds the surface at a point. False near an edge.
  bool shows_one(float x, float y, std::size_t& surface) const {
    if (!(half_m_ * (1.0f - std::max(std::abs(x), std::abs(y))) >= pure_m_)) return false;
    surface = outlines_.size();
    for (std::size_t k = 0; k < outlines_.size(); ++k) {
      const float dx = half_m_ * x - layout_.patches[k].x_m, dy = half_m_ * y - layout_.patches[k].y_m;
      const float c = outlines_[k].cos(), s = outlines_[k].sin();
      const float depth = outlines_[k].depth_m({c * dx + s * dy, c * dy - s * dx});
      if (std::abs(depth) < pure_m_) return false;
      if (depth > 0.0f) surface = k;
    }
    return true;
  }
  bool read(float x, float y, std::array<float, 3>& rgb) const {
    const float u = middle_.u_px + x * by_x_.u_px + y * by_y_.u_px + 0.5f;
    const float v = middle_.v_px + x * by_x_.v_px + y * by_y_.v_px + 0.5f;
    const auto width = static_cast<float>(frame_.width_px), height = static_cast<float>(frame_.height_px);
    if (!(u >= 0.0f && v >= 0.0f && u < width && v < height)) return false;
    const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& channel = info_.channel[c];
      const std::size_t line = (row >> channel.shift_v) * frame_.stride_bytes[channel.plane];
      rgb[c] = frame_.plane[channel.plane][line + channel.byte(column)];
    }
    rgb = to_rgb(rgb, info_.space);
    return true;
  }

  const Frame& frame_;
  const PixelFormatInfo& info_;
  const MarkerLayout& layout_;
  float half_m_, pure_m_ = 0;
  PixelPoint middle_, by_x_, by_y_;
  FixedVector<BlurredOutline, kMaxPatches> outlines_;
};

// What varies of the lamp's light, and the variance of one sample's light around surfaces and lamp.
struct Lamp {
  LampTerms by = LampTerms::Zero();
  float variance = 0;
};

// Each surface's own light is projected out of the least squares: its means are subtracted.
Lamp lamp_on(const Surfaces& surfaces) {
  LampEquations normal = LampEquations::Zero();
  LampTerms right = LampTerms::Zero();
  float squares = 0, freedom = -kLampTerms;
  for (const Surface& one : surfaces) {
    if (one.clear == 0) continue;
    normal += one.squares - one.clear_terms * one.clear_terms.transpose() / one.clear;
    right += one.gray_terms - one.clear_terms * (one.gray / one.clear);
    squares += one.gray_squares - one.gray * one.gray / one.clear;
    freedom += one.clear - 1;
    normal += LampTerms::Constant(kUniform * one.clear).asDiagonal();
  }
  Lamp lamp;
  if (freedom < 1) return lamp;
  lamp.by = normal.ldlt().solve(right);
  lamp.variance = std::max(0.0f, squares - lamp.by.dot(right)) / freedom;
  return lamp;
}

}  // namespace

bool see_paints(const Frame& frame, const CameraModel& camera, const MarkerLayout& layout, const Pose& pose,
                const std::array<float, 3>& usual_top, int saturated_from, PaintColors& out) {
  Surfaces surfaces;
  TopSampler(frame, camera, layout, pose).sample(static_cast<float>(saturated_from), surfaces);
  for (const Surface& one : surfaces) {
    const bool is_white = one.is_saturated(0) && one.is_saturated(1) && one.is_saturated(2);
    if (one.count < kMinSamples || is_white) return false;
  }
  const Lamp lamp = lamp_on(surfaces);
  const Surface& top = surfaces.back();
  // Then nothing tells how much light the lamp adds.
  if (top.is_saturated(0) || top.is_saturated(1) || top.is_saturated(2)) return false;
  out.clear();
  for (std::size_t k = 0; k + 1 < surfaces.size(); ++k) {
    const Surface& patch = surfaces[k];
    const float more_lamp = lamp.by.dot(patch.terms / patch.count - top.terms / top.count);
    const float sigma = std::sqrt(lamp.variance * (1.0f / patch.count + 1.0f / top.count));
    SurfaceColor paint;
    paint.saturated_from = saturated_from;
    float power = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float above_top = patch.light[c] / patch.count - top.light[c] / top.count - more_lamp;
      power += above_top * above_top;
      const float light = usual_top[c] + above_top;
      paint.rgb[c] = to_value(light);
      paint.spread[c] = 0.5f * (to_value(light + sigma) - to_value(light - sigma));
      paint.saturated[c] = patch.is_saturated(c);
    }
    if (3.0f * lamp.variance > kMaxUnevenness * kMaxUnevenness * power) return false;
    out.push_back(paint);
  }
  return true;
}

}  // namespace touchline
