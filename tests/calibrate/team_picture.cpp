#include "tests/calibrate/team_picture.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "hal/mock/lens.h"
#include "hal/mock/lighting.h"
#include "hal/mock/random.h"

namespace touchline::calibrate {
namespace {

using Light = std::array<double, 3>;
using FloorPlace = std::complex<double>;

Light linear(const PaintRgb& rgb) {
  Light out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double x = std::clamp(rgb[c], 0.0, 255.0) / 255;
    out[c] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  return out;
}

double encoded(double x) {
  const double y = std::clamp(x, 0.0, 1.0);
  return 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055);
}

// Returns whether a point in the patch's own frame, relative to the centroid, lies on it.
bool covers(const PatchPlace& place, FloorPlace at) {
  const auto length = static_cast<double>(place.length_m), width = static_cast<double>(place.width_m);
  const FloorPlace own = at * std::polar(1.0, -static_cast<double>(place.turn_rad));
  switch (place.outline) {
    case PatchOutline::kCircle:
      return std::abs(own) <= length / 2;
    case PatchOutline::kTriangle:
      return own.real() >= -length / 3 && std::abs(own.imag()) <= width / 2 * (2 * length / 3 - own.real()) / length;
    case PatchOutline::kSquare:
    case PatchOutline::kBar:
      break;
  }
  return std::abs(own.real()) <= length / 2 && std::abs(own.imag()) <= width / 2;
}

class Scenery {
 public:
  Scenery(const TeamScene& scene, const hal::mock::ArenaField& field, const hal::mock::LensParameters& lens,
          const hal::mock::LightParameters& light)
      : scene_(scene), field_(field), lens_(lens), light_(light, field), eye_(lens_.position_m()) {}

  [[nodiscard]] Light seen(double u, double v) const {
    const hal::mock::Vec3 ray = lens_.unproject(u, v);
    const double down = std::max(-ray[2], 0.05);
    const FloorPlace way{ray[0] / down, ray[1] / down}, eye{eye_[0], eye_[1]};
    const auto at = [&](double height) { return eye + way * (eye_[2] - height); };
    const auto height = static_cast<double>(scene_.layout.height_m);
    // A robot is a stack of squares, the patches on the highest one; the ball is lower.
    constexpr int kSlices = 5;
    for (int slice = kSlices; slice > 0; --slice) {
      const double z = height * slice / kSlices;
      if (const StandingRobot* const robot = robot_at(at(z)); robot != nullptr)
        return lit(slice == kSlices ? top(*robot, at(z)) : side(), at(z), z);
    }
    if (scene_.has_ball) {
      const double radius = scene_.ball_radius_m;
      const double off = std::abs(at(radius) - FloorPlace{scene_.ball_x_m, scene_.ball_y_m}) / radius;
      if (off < 1) {
        Light color = linear(scene_.ball);
        for (double& c : color) c *= 0.4 + 0.6 * std::sqrt(1 - off * off);
        return lit(color, at(radius), radius);
      }
    }
    const StandingRobot* const standing = robot_at(at(0));
    return lit(standing != nullptr ? side() : ground(at(0)), at(0), 0);
  }

 private:
  [[nodiscard]] const StandingRobot* robot_at(FloorPlace at) const {
    const double half = static_cast<double>(scene_.layout.robot_side_m) / 2;
    for (const StandingRobot& robot : scene_.robots) {
      const FloorPlace own = (at - FloorPlace{robot.x_m, robot.y_m}) * std::polar(1.0, -robot.theta_rad);
      if (std::abs(own.real()) <= half && std::abs(own.imag()) <= half) return &robot;
    }
    return nullptr;
  }
  [[nodiscard]] Light top(const StandingRobot& robot, FloorPlace at) const {
    const FloorPlace own = (at - FloorPlace{robot.x_m, robot.y_m}) * std::polar(1.0, -robot.theta_rad);
    for (std::size_t i = 0; i < scene_.layout.patches.size(); ++i) {
      const PatchPlace& place = scene_.layout.patches[i];
      const FloorPlace center{static_cast<double>(place.x_m), static_cast<double>(place.y_m)};
      if (!covers(place, own - center)) continue;
      Light color = linear(robot.paint[i]);
      for (double& c : color) c += robot.glare[i];
      return color;
    }
    return linear(scene_.body);
  }
  [[nodiscard]] Light side() const {
    Light color = linear(scene_.body);
    for (double& c : color) c *= 0.5;
    return color;
  }
  [[nodiscard]] Light ground(FloorPlace at) const {
    const double x = std::abs(at.real()), y = std::abs(at.imag());
    const double length = field_.length_m / 2, width = field_.width_m / 2, line = field_.line_m / 2;
    const bool goal = y < field_.goal_width_m / 2 && x < length + field_.goal_depth_m;
    if (x > length || y > width) {
      if (goal) return linear(scene_.floor);
      return linear(x < length + field_.border_m && y < width + field_.border_m ? scene_.line : scene_.outside);
    }
    const bool circle = std::abs(std::abs(at) - field_.circle_radius_m) < line;
    const bool area =
        (std::abs(x - (length - 0.15)) < line && y < 0.35) || (std::abs(y - 0.35) < line && x > length - 0.15);
    const bool dot = std::hypot(x - length / 2, y - width * 0.6) < 0.0125;
    return linear(x < line || circle || area || dot ? scene_.line : scene_.floor);
  }
  [[nodiscard]] Light lit(Light color, FloorPlace at, double z) const {
    const double light = static_cast<double>(
        light_.irradiance(static_cast<float>(at.real()), static_cast<float>(at.imag()), static_cast<float>(z)));
    for (double& c : color) c *= light;
    return color;
  }

  const TeamScene& scene_;
  const hal::mock::ArenaField& field_;
  const hal::mock::Lens lens_;
  const hal::mock::Lighting light_;
  const hal::mock::Vec3 eye_;
};

void blur(std::vector<Light>& image, int width, int height, double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(2.5 * sigma)));
  std::vector<double> kernel;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    kernel.push_back(std::exp(-k * k / (2 * sigma * sigma)));
    sum += kernel.back();
  }
  std::vector<Light> source;
  for (const bool rows : {true, false}) {
    source = image;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        Light mean{};
        for (int k = -reach; k <= reach; ++k) {
          const int x = std::clamp(rows ? u + k : u, 0, width - 1), y = std::clamp(rows ? v : v + k, 0, height - 1);
          for (std::size_t c = 0; c < 3; ++c)
            mean[c] +=
                kernel[static_cast<std::size_t>(k + reach)] / sum * source[static_cast<std::size_t>(y * width + x)][c];
        }
        image[static_cast<std::size_t>(v * width + u)] = mean;
      }
    }
  }
}

// Replaces the differences to luma by their mean over 2 x 2 pixels.
void share_chroma(std::vector<Light>& image, int width, int height) {
  const auto luma = [](const Light& p) { return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]; };
  for (int v = 0; v + 1 < height; v += 2) {
    for (int u = 0; u + 1 < width; u += 2) {
      std::array<Light*, 4> block{};
      Light mean{};
      for (int i = 0; i < 4; ++i) {
        block[static_cast<std::size_t>(i)] = &image[static_cast<std::size_t>((v + i / 2) * width + u + i % 2)];
        const Light& p = *block[static_cast<std::size_t>(i)];
        for (std::size_t c = 0; c < 3; ++c) mean[c] += (p[c] - luma(p)) / 4;
      }
      for (Light* const p : block) {
        const double y = luma(*p);
        for (std::size_t c = 0; c < 3; ++c) (*p)[c] = y + mean[c];
      }
    }
  }
}

}  // namespace

hal::Picture draw_scene(const TeamScene& scene, const hal::mock::ArenaField& field,
                        const hal::mock::LensParameters& lens, const hal::mock::LightParameters& light,
                        const Exposure& exposure, int width_px, int height_px, unsigned seed) {
  const Scenery scenery(scene, field, lens, light);
  std::vector<Light> image(static_cast<std::size_t>(width_px * height_px));
  const double half_diagonal = std::hypot(width_px, height_px) / 2;
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      Light& pixel = image[static_cast<std::size_t>(v * width_px + u)];
      const double off = std::hypot(u - width_px / 2.0, v - height_px / 2.0) / half_diagonal;
      for (const double dv : {-0.25, 0.25}) {
        for (const double du : {-0.25, 0.25}) {
          const Light ray = scenery.seen(u + du, v + dv);
          for (std::size_t c = 0; c < 3; ++c) pixel[c] += ray[c] / 4;
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = exposure.gain * exposure.tint[c] * (1 - lens.vignetting * off * off) * pixel[c] + exposure.veil;
      }
    }
  }
  blur(image, width_px, height_px, exposure.blur_px);
  hal::mock::Random random(seed, 7);
  for (Light& pixel : image) {
    for (double& c : pixel) c = std::clamp(encoded(c) + exposure.noise * random.normal(), 0.0, 255.0);
  }
  if (exposure.shares_chroma) share_chroma(image, width_px, height_px);
  hal::Picture out;
  out.width_px = static_cast<std::uint32_t>(width_px);
  out.height_px = static_cast<std::uint32_t>(height_px);
  for (const Light& pixel : image) {
    for (const double c : pixel) out.rgb8.push_back(static_cast<std::uint8_t>(std::clamp(c + 0.5, 0.0, 255.0)));
  }
  return out;
}

}  // namespace touchline::calibrate
