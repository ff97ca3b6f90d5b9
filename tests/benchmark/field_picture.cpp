#include "tests/benchmark/field_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/color/rgb_to_yuv.h"

namespace touchline::testing {
namespace {

using Rgb = std::array<double, 3>;

// One color for the ball, two for teams, ten for identification; the paper used 13 colors.
constexpr std::array<Rgb, 13> kPaints = {{{235, 120, 30},
                                          {225, 215, 40},
                                          {40, 70, 215},
                                          {225, 35, 45},
                                          {235, 110, 150},
                                          {200, 40, 200},
                                          {120, 50, 180},
                                          {40, 200, 220},
                                          {60, 225, 60},
                                          {160, 225, 110},
                                          {30, 150, 130},
                                          {150, 85, 40},
                                          {185, 160, 235}}};
constexpr std::size_t kBall = 0, kFirstTeam = 1, kFirstIdentification = 3;
constexpr Rgb kCarpet = {48, 92, 56}, kLine = {196, 200, 192}, kFloor = {74, 72, 70}, kRobot = {26, 26, 30};
// Half width of the color boxes, and of their chroma channels in YUV.
constexpr int kBoxHalfWidth = 24, kChromaHalfWidth = 9;

constexpr double kFieldLength_m = 2.2, kFieldWidth_m = 1.8, kRobot_m = 0.075, kPatch_m = 0.0375, kBall_m = 0.021;
constexpr double kLine_m = 0.01, kCircle_m = 0.25, kMargin_m = 0.06;

struct PlacedRobot {
  double x = 0.0, y = 0.0, cosine = 1.0, sine = 0.0;
  std::size_t team = 0, identification = 0;
};

class Field {
 public:
  explicit Field(std::mt19937& random) {
    for (std::size_t i = 0; i < 10; ++i) robots_.push_back(place_robot(random, i));
    ball_x_ = between(random, -0.9, 0.9);
    ball_y_ = between(random, -0.7, 0.7);
  }

  // Returns the color of a point; x and y are from the field's center in meters.
  [[nodiscard]] Rgb at(double x, double y) const {
    if (std::hypot(x - ball_x_, y - ball_y_) < kBall_m) return kPaints[kBall];
    for (const PlacedRobot& robot : robots_) {
      const double dx = x - robot.x, dy = y - robot.y;
      const double along = dx * robot.cosine + dy * robot.sine, left = dy * robot.cosine - dx * robot.sine;
      if (std::max(std::abs(along), std::abs(left)) > kRobot_m / 2) continue;
      // Two patches are in opposite quadrants (figure 2).
      const double gap = kRobot_m / 2 - kPatch_m * 0.95;
      if (along > gap && left > gap) return kPaints[robot.team];
      if (along < -gap && left < -gap) return kPaints[robot.identification];
      return kRobot;
    }
    return ground(x, y);
  }

 private:
  static double between(std::mt19937& random, double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  }

  PlacedRobot place_robot(std::mt19937& random, std::size_t number) {
    PlacedRobot robot;
    do {
      robot.x = between(random, -1.0, 1.0);
      robot.y = between(random, -0.8, 0.8);
    } while (std::any_of(robots_.begin(), robots_.end(), [&](const PlacedRobot& other) {
      return std::hypot(other.x - robot.x, other.y - robot.y) < 1.5 * kRobot_m;
    }));
    const double heading = between(random, -std::numbers::pi, std::numbers::pi);
    robot.cosine = std::cos(heading);
    robot.sine = std::sin(heading);
    robot.team = kFirstTeam + number % 2;
    robot.identification = kFirstIdentification + number;
    return robot;
  }

  static Rgb ground(double x, double y) {
    const double beyond = std::max(std::abs(x) - kFieldLength_m / 2, std::abs(y) - kFieldWidth_m / 2);
    if (beyond > kMargin_m) return kFloor;
    const bool line = std::abs(beyond) < kLine_m / 2 || (beyond < 0 && std::abs(x) < kLine_m / 2) ||
                      std::abs(std::hypot(x, y) - kCircle_m) < kLine_m / 2;
    return line ? kLine : kCarpet;
  }

  std::vector<PlacedRobot> robots_;
  double ball_x_ = 0.0, ball_y_ = 0.0;
};

std::uint8_t in_byte(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))); }

// Returns an approximately normal number with unit standard deviation: the sum of four uniform bytes.
double unit_noise(std::mt19937& random) {
  const auto bits = static_cast<std::uint32_t>(random());
  const std::uint32_t sum = (bits & 255u) + (bits >> 8 & 255u) + (bits >> 16 & 255u) + (bits >> 24);
  return (sum - 510.0) / 147.8;
}

// Returns the brightness of a floor: the sum of three layers of noise, each interpolated between points with random
// values.
class FloorTexture {
 public:
  FloorTexture(double deviation, std::uint32_t seed) : deviation_(deviation) {
    std::mt19937 random(seed);
    for (double& value : values_) value = unit_noise(random);
  }
  [[nodiscard]] double at(int u, int v) const {
    if (deviation_ <= 0.0) return 0.0;
    double sum = 0.0;
    for (std::size_t layer = 0; layer < 3; ++layer) {
      const int scale = 4 << (2 * layer), column = u / scale, row = v / scale;
      const double x = u % scale / static_cast<double>(scale), y = v % scale / static_cast<double>(scale);
      const double above = (1 - x) * value(layer, column, row) + x * value(layer, column + 1, row);
      const double below = (1 - x) * value(layer, column, row + 1) + x * value(layer, column + 1, row + 1);
      sum += (1 - y) * above + y * below;
    }
    // The mean of interpolated values has two thirds of their deviation in each direction.
    return deviation_ * 1.5 / std::sqrt(3.0) * sum;
  }

 private:
  static constexpr std::size_t kSide = 64;
  [[nodiscard]] double value(std::size_t layer, int column, int row) const {
    const auto u = static_cast<std::size_t>(column) % kSide, v = static_cast<std::size_t>(row) % kSide;
    return values_[(layer * kSide + v) * kSide + u];
  }

  double deviation_;
  std::vector<double> values_ = std::vector<double>(3 * kSide * kSide);
};

}  // namespace

OwnedPicture paint_field(const FieldScene& scene) {
  std::mt19937 random(scene.seed);
  const Field field(random);
  const ColorSpace space = color_space(scene.format);
  const double meters = (kFieldWidth_m + 2 * kMargin_m + 0.1) / scene.height_px;
  const auto speck_below = static_cast<std::uint32_t>(scene.specks_per_megapixel / 1e6 * 4294967295.0);
  const FloorTexture texture(scene.texture, scene.seed);
  OwnedPicture picture(scene.format, scene.width_px, scene.height_px, 0);
  for (int v = 0; v < scene.height_px; ++v) {
    for (int u = 0; u < scene.width_px; ++u) {
      Rgb color{};
      for (const double du : {-0.5, 0.0, 0.5}) {
        for (const double dv : {-0.5, 0.0, 0.5}) {
          const Rgb sample =
              field.at((u + du - scene.width_px / 2.0) * meters, (scene.height_px / 2.0 - v - dv) * meters);
          for (std::size_t c = 0; c < 3; ++c) color[c] += sample[c] / 9.0;
        }
      }
      if (random() < speck_below) {
        for (double& channel : color) channel = static_cast<double>(random() % 256u);
      }
      const double brighter = texture.at(u, v);
      for (double& channel : color) channel += brighter;
      const Rgb value = in_space(space, color);
      Channels bytes{};
      for (std::size_t c = 0; c < 3; ++c) bytes[c] = in_byte(value[c] + scene.noise * unit_noise(random));
      picture.set(u, v, bytes);
    }
  }
  return picture;
}

ScanParameters field_parameters(const FieldScene& scene) {
  ScanParameters parameters;
  parameters.format = scene.format;
  parameters.width_px = static_cast<std::uint16_t>(scene.width_px);
  parameters.height_px = static_cast<std::uint16_t>(scene.height_px);
  const ColorSpace space = color_space(scene.format);
  for (std::size_t i = 0; i < kPaints.size(); ++i) {
    const Rgb middle = in_space(space, kPaints[i]);
    ColorBox box;
    box.color = static_cast<ColorId>(i + 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const int reach = is_yuv(space) && c > 0 ? kChromaHalfWidth : kBoxHalfWidth;
      box.low[c] = in_byte(middle[c] - reach);
      box.high[c] = in_byte(middle[c] + reach);
    }
    parameters.boxes.push_back(box);
  }
  return parameters;
}

}  // namespace touchline::testing
