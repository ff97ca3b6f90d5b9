#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/mock/arena_parameters.h"
#include "hal/mock/lens.h"
#include "hal/mock/lighting.h"
#include "hal/mock/world.h"

namespace touchline::hal::mock {

/// Full scale of the linear pictures that go to the sensor.
inline constexpr int kLinearScale = 4095;

enum class Floor : std::uint8_t { kField, kGreyPaper };

/// Draws what the camera sees in linear light, ray by ray: 4 x 4 rays a pixel, each at another instant of the exposure,
/// so that edges are smooth and what moves is blurred. Robots are cuboids with patches on top, the ball is a shaded
/// sphere, nearer things hide what is behind. The floor is drawn once; a frame costs the pixels that things cover.
class Renderer {
 public:
  Renderer(const ArenaParameters& parameters, std::uint16_t width_px, std::uint16_t height_px,
           Floor floor = Floor::kField);

  /// `begin`, `end`: of the exposure. Allocates nothing. R, G, B of each pixel, 0 to kLinearScale; valid until the next
  /// call.
  std::span<const std::uint16_t> render(const Snapshot& begin, const Snapshot& end);
  /// Nothing on it.
  [[nodiscard]] std::span<const std::uint16_t> render_floor() const { return floor_; }
  /// The lamps are out.
  [[nodiscard]] std::span<const std::uint16_t> render_dark() const { return dark_; }

  [[nodiscard]] const Lens& lens() const { return lens_; }

 private:
  static constexpr int kRaysAside = 4;
  static constexpr int kRays = kRaysAside * kRaysAside;

  // A direction, scaled so that it goes down by 1.
  struct Sight {
    float x = 0.0f, y = 0.0f;
  };
  struct Patch {
    PatchShape shape = PatchShape::kSquare;
    float x = 0.0f, y = 0.0f, length = 0.0f, width = 0.0f;
    Linear color{};
  };
  struct Look {
    FixedVector<Patch, kMaxPatches> patches;
  };
  struct Turned {
    float x = 0.0f, y = 0.0f, cos = 1.0f, sin = 0.0f;
  };
  // One robot or, without looks, the ball, at the instant of each ray.
  struct Thing {
    const Look* look = nullptr;
    std::array<Turned, kRays> at{};
  };
  struct Hit {
    float height_m = -1.0f;  // of the point that was hit; the highest is the nearest to the camera
    Linear color{};
  };

  void draw_floor(Floor floor);
  [[nodiscard]] Linear floor_color(float x_m, float y_m, Floor floor) const;
  void add(const Look* look, const Placement& begin, const Placement& end, float radius_m, float height_m);
  void draw_pixel(std::size_t index, std::uint32_t things);
  void hit_robot(const Thing& thing, int ray, Sight sight, float top_light, Hit& hit) const;
  void hit_ball(const Thing& thing, int ray, Sight sight, Hit& hit) const;
  void store(std::size_t index, const Linear& light);

  const ArenaParameters parameters_;
  std::size_t width_ = 0, height_ = 0;
  Lens lens_;
  Lighting lighting_;
  float side_half_ = 0.0f, robot_height_ = 0.0f, ball_radius_ = 0.0f, scale_ = 0.0f;
  std::array<float, 3> eye_{};
  Linear body_{}, ball_{}, line_{}, ground_{}, outside_{};
  std::vector<Look> looks_;
  std::vector<Sight> sights_;  // of each pixel's middle; differences to the neighbors give the rays between
  std::vector<float> vignette_;
  std::vector<std::uint16_t> floor_, picture_, dark_;
  std::vector<std::uint32_t> covered_by_;  // bit i: thing i
  std::vector<std::uint32_t> covered_;     // pixels drawn in this frame
  FixedVector<Thing, kMaxRobots + 1> things_;
  std::vector<Lighting::Beam> ball_beams_;
};

}  // namespace touchline::hal::mock
