#include "tools/programs/relight/painted_things.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <random>

namespace touchline::relight {
namespace {

using Rgb = std::array<double, 3>;

constexpr double kCameraGamma = 2.2;
// Half the side, in px, of the square in which the median of the floor is taken; it is much larger than a robot.
constexpr int kFloorReach = 40;
// Standard deviation of the sensor's noise, in levels.
constexpr double kNoise = 1.2;
constexpr int kSubpixels = 4;

double linear(double level) { return std::pow(level / 255.0, kCameraGamma); }

struct Point {
  double x = 0, y = 0;
};

double distance_to_segment(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double along = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

// What a thing shows at a point of its own coordinates, in which its length is 1.
struct Spot {
  std::size_t color = 0;
  double shade = 1;
};

class Shape {
 public:
  explicit Shape(const Thing& thing) : thing_(thing) {
    std::mt19937_64 random(thing.seed);
    // Uses the generator's bits directly, because the standard distributions differ between libraries.
    for (double& one : jitter_) one = static_cast<double>(random() >> 11U) / 9007199254740992.0 - 0.5;
  }

  /// Returns the largest distance of the thing's points from its center.
  [[nodiscard]] double reach() const { return thing_.kind == ThingKind::kHand ? 4.0 : 1.0; }

  [[nodiscard]] std::optional<Spot> at(Point p) const {
    switch (thing_.kind) {
      case ThingKind::kPaper:
        return paper(p);
      case ThingKind::kHand:
        return hand(p);
      case ThingKind::kShoe:
        return shoe(p);
      case ThingKind::kRobot:
        return robot(p);
      case ThingKind::kGlare:
        return std::nullopt;  // covers nothing
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<Spot> paper(Point p) const {
    std::array<Point, 4> corner{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
    for (std::size_t i = 0; i < 4; ++i) {
      corner[i].x += 0.2 * jitter_[2 * i];
      corner[i].y = thing_.width * (corner[i].y + 0.2 * jitter_[2 * i + 1]);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Point a = corner[i], b = corner[(i + 1) % 4];
      if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0) return std::nullopt;
    }
    return Spot{};
  }
  [[nodiscard]] std::optional<Spot> hand(Point p) const {
    constexpr double kFinger = 0.1, kArm = 0.32;
    const double palm = std::hypot(p.x / 0.5, p.y / 0.42);
    if (palm < 1) return Spot{0, 1.0 - 0.2 * palm * palm};
    for (std::size_t i = 0; i < 5; ++i) {
      // Finger 0 is the thumb.
      const double angle = (i == 0 ? -1.2 : -0.5 + 0.3 * static_cast<double>(i - 1)) + 0.15 * jitter_[i];
      const double length = i == 0 ? 0.75 : 1.0 + 0.2 * jitter_[i];
      const double away = distance_to_segment(p, {}, {length * std::cos(angle), length * std::sin(angle)}) / kFinger;
      if (away < 1) return Spot{0, 1.0 - 0.3 * away * away};
    }
    const double away = distance_to_segment(p, {}, {-4, 0}) / kArm;
    if (away < 1) return Spot{p.x > -0.9 ? 0U : 1U, 1.0 - 0.4 * away * away};
    return std::nullopt;
  }
  [[nodiscard]] std::optional<Spot> shoe(Point p) const {
    const double inside = std::hypot(p.x / 0.5, p.y / (p.x > 0 ? 0.2 : 0.16));
    if (inside >= 1) return std::nullopt;
    const bool stripe = p.x > -0.2 && p.x < 0.25 && std::fmod(p.x + 1.0, 0.15) < 0.07 && std::abs(p.y) > 0.05;
    return Spot{stripe ? 1U : 0U, 1.0 - 0.4 * inside * inside};
  }
  [[nodiscard]] static std::optional<Spot> robot(Point p) {
    if (std::max(std::abs(p.x), std::abs(p.y)) > 0.5) return std::nullopt;
    const double half = 0.23;  // half the side of a patch
    for (const double sign : {1.0, -1.0}) {
      if (std::max(std::abs(p.x - 0.25 * sign), std::abs(p.y - 0.25 * sign)) < half) {
        return Spot{sign > 0 ? 1U : 2U, 1.0};
      }
    }
    return Spot{};
  }

  const Thing& thing_;
  std::array<double, 8> jitter_{};
};

// Returns the median of the pixels around a position, linear in light.
Rgb floor_around(const hal::Picture& picture, double u_px, double v_px) {
  Rgb out{};
  const auto from = [](double center, std::uint32_t size) {
    return std::clamp<int>(static_cast<int>(std::lround(center)) - kFloorReach, 0, static_cast<int>(size) - 1);
  };
  const int left = from(u_px, picture.width_px), top = from(v_px, picture.height_px);
  const int right = std::min(left + 2 * kFloorReach, static_cast<int>(picture.width_px));
  const int bottom = std::min(top + 2 * kFloorReach, static_cast<int>(picture.height_px));
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::uint8_t> levels;
    for (int v = top; v < bottom; ++v) {
      for (int u = left; u < right; ++u) {
        levels.push_back(
            picture.rgb8[3 * (static_cast<std::size_t>(v) * picture.width_px + static_cast<std::size_t>(u)) + c]);
      }
    }
    const auto middle = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 2);
    std::nth_element(levels.begin(), middle, levels.end());
    out[c] = linear(std::max<int>(1, *middle));
  }
  return out;
}

// Returns the light that a surface of this color reflects at a position of the picture.
Rgb color_at(const hal::Picture& picture, const ThingColor& color, const Rgb& floor_there) {
  Rgb out{}, floor_here{};
  if (color.like_pixel) {
    floor_here = floor_around(picture, color.pixel[0], color.pixel[1]);
    int count = 0;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        const auto u = static_cast<std::int64_t>(std::lround(color.pixel[0])) + du;
        const auto v = static_cast<std::int64_t>(std::lround(color.pixel[1])) + dv;
        if (u < 0 || v < 0 || u >= picture.width_px || v >= picture.height_px) continue;
        for (std::size_t c = 0; c < 3; ++c) {
          out[c] += linear(picture.rgb8[3 * static_cast<std::size_t>(v * picture.width_px + u) + c]);
        }
        ++count;
      }
    }
    for (double& one : out) one /= std::max(1, count);
  } else {
    floor_here = floor_around(picture, 0.5 * picture.width_px, 0.5 * picture.height_px);
    for (std::size_t c = 0; c < 3; ++c) out[c] = linear(color.rgb[c]);
  }
  for (std::size_t c = 0; c < 3; ++c) out[c] *= floor_there[c] / floor_here[c];
  return out;
}

// Returns a nearly normal deviate with variance 1: a sum of uniform deviates (Irwin-Hall).
double noise(std::mt19937_64& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11U) / 9007199254740992.0;
  return sum;
}

void paint_one(const Thing& thing, const hal::Picture& original, hal::Picture& picture) {
  const Shape shape(thing);
  const Rgb floor = floor_around(original, thing.u_px, thing.v_px);
  std::vector<Rgb> colors;
  for (const ThingColor& color : thing.colors) colors.push_back(color_at(original, color, floor));
  std::mt19937_64 random(thing.seed);
  const double reach = shape.reach() * thing.size_px + 1;
  const double c = std::cos(thing.angle_rad), s = std::sin(thing.angle_rad);
  const auto first = [reach](double center) { return static_cast<std::uint32_t>(std::max(0.0, center - reach)); };
  const auto end = [reach](double center, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(center + reach + 1, 0.0, static_cast<double>(size)));
  };
  for (std::uint32_t v = first(thing.v_px); v < end(thing.v_px, picture.height_px); ++v) {
    for (std::uint32_t u = first(thing.u_px); u < end(thing.u_px, picture.width_px); ++u) {
      Rgb sum{};
      int covered = 0;
      for (int i = 0; i < kSubpixels * kSubpixels; ++i) {
        const int column = i % kSubpixels, row = i / kSubpixels;
        const double x = u + (column + 0.5) / kSubpixels - 0.5 - thing.u_px;
        const double y = v + (row + 0.5) / kSubpixels - 0.5 - thing.v_px;
        const auto spot = shape.at({(c * x + s * y) / thing.size_px, (c * y - s * x) / thing.size_px});
        if (!spot) continue;
        ++covered;
        const Rgb& color = colors[std::min(spot->color, colors.size() - 1)];
        for (std::size_t k = 0; k < 3; ++k) sum[k] += spot->shade * color[k];
      }
      if (covered == 0) continue;
      constexpr double kAll = kSubpixels * kSubpixels;
      std::uint8_t* rgb = &picture.rgb8[3 * (std::size_t{v} * picture.width_px + u)];
      for (std::size_t k = 0; k < 3; ++k) {
        const double light = (sum[k] + (kAll - covered) * linear(rgb[k])) / kAll;
        const double level = 255.0 * std::pow(std::min(1.0, light), 1.0 / kCameraGamma);
        rgb[k] = static_cast<std::uint8_t>(std::clamp(std::lround(level + kNoise * noise(random)), 0L, 255L));
      }
    }
  }
}

// Adds a spot of light that is uniform in the middle and has a smooth edge: half of it beyond 0.87 radii, nothing
// beyond two.
void add_glare(const Thing& glare, hal::Picture& picture) {
  const double radius = 0.5 * glare.size_px;
  for (std::uint32_t v = 0; v < picture.height_px; ++v) {
    for (std::uint32_t u = 0; u < picture.width_px; ++u) {
      const double away = std::hypot(u - glare.u_px, v - glare.v_px) / radius;
      if (away >= 2.0) continue;
      const double added = glare.light * std::exp(-0.5 * std::pow(away / 0.8, 4));
      std::uint8_t* rgb = &picture.rgb8[3 * (std::size_t{v} * picture.width_px + u)];
      for (std::size_t k = 0; k < 3; ++k) {
        const double light = std::min(1.0, linear(rgb[k]) + added);
        rgb[k] = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(light, 1.0 / kCameraGamma)));
      }
    }
  }
}

}  // namespace

Result<Things> read_things(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::kNotFound, path + ": cannot be read"};
  const std::map<std::string, ThingKind> kinds{{"paper", ThingKind::kPaper},
                                               {"hand", ThingKind::kHand},
                                               {"shoe", ThingKind::kShoe},
                                               {"robot", ThingKind::kRobot},
                                               {"glare", ThingKind::kGlare}};
  Things out;
  try {
    const nlohmann::json pictures = nlohmann::json::parse(file);
    for (const auto& [name, list] : pictures.items()) {
      for (const auto& one : list) {
        Thing thing;
        thing.kind = kinds.at(one.at("kind").get<std::string>());
        thing.u_px = one.at("u");
        thing.v_px = one.at("v");
        thing.size_px = one.at("size");
        thing.width = one.value("width", 1.0);
        thing.angle_rad = one.value("angle", 0.0);
        thing.seed = one.value("seed", std::uint64_t{1});
        thing.light = one.value("light", 0.0);
        for (const auto& color : one.value("colors", nlohmann::json::array())) {
          ThingColor& added = thing.colors.emplace_back();
          added.like_pixel = color.contains("like");
          if (added.like_pixel) {
            color.at("like").get_to(added.pixel);
          } else {
            color.at("rgb").get_to(added.rgb);
          }
        }
        const bool has_light = thing.light > 0 && thing.light <= 1;
        if ((thing.kind == ThingKind::kGlare ? !has_light : thing.colors.empty()) || !(thing.size_px > 0) ||
            !(thing.size_px < 1000)) {
          return Error{ErrorCode::kInconsistent,
                       std::string(path).append(": ").append(name) +
                           ": a thing needs a color (glare: a light of at most 1) and a size below 1000 px"};
        }
        out[name].push_back(thing);
      }
    }
  } catch (const std::exception& wrong) {
    return Error{ErrorCode::kInconsistent, path + ": " + wrong.what()};
  }
  return out;
}

void paint(const std::vector<Thing>& things, hal::Picture& picture) {
  const hal::Picture original = picture;
  for (const Thing& thing : things) {
    if (thing.kind == ThingKind::kGlare) {
      add_glare(thing, picture);
    } else {
      paint_one(thing, original, picture);
    }
  }
}

}  // namespace touchline::relight
