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

/// Full scale of the linear pictures that the sensor converts.
inline constexpr int kLinearScale = 4095;

enum class Floor : std::uint8_t { kField, kGreyPaper };

/// Times at which the rows of a picture are exposed, between the beginning (0) and the end (1) of the motion.
struct RowTiming {
  float begin_per_row = 0.0f;  // start of a row's exposure after that of the row above; 0: global shutter
  float exposure = 1.0f;       // duration of each row's exposure
};

/// Renders the camera's view in linear light by distributed ray tracing (Cook, Porter and Carpenter 1984): 16 samples
/// per pixel, each at another instant of the exposure, which gives anti-aliased edges and motion blur. Each sample has
/// its own square, row and column (multi-jittered sampling, Chiu, Shirley and Wang 1994). Robots are cuboids with
/// patches on top; the ball is a shaded sphere; nearer objects hide farther ones. The floor is rendered once, so a
/// frame costs only the pixels that objects cover.
class Renderer {
 public:
  Renderer(const ArenaParameters& parameters, std::uint16_t width_px, std::uint16_t height_px,
           Floor floor = Floor::kField);

  /// Renders a frame. `begin`, `end`: the scene at the beginning of the first row's exposure and at the end of the last
  /// row's; objects move straight and turn evenly between them. `hidden`: bit i is set if robot i is not drawn. Returns
  /// R, G, B of each pixel, 0 to kLinearScale, valid until the next call. Does not allocate.
  std::span<const std::uint16_t> render(const Snapshot& begin, const Snapshot& end, const RowTiming& rows = {},
                                        std::uint32_t hidden = 0);
  /// Returns the floor without objects.
  [[nodiscard]] std::span<const std::uint16_t> render_floor() const { return floor_; }
  /// Returns the view with all lamps off.
  [[nodiscard]] std::span<const std::uint16_t> render_dark() const { return dark_; }

  [[nodiscard]] const Lens& lens() const { return lens_; }

 private:
  static constexpr int kSamples = 16;
  static constexpr std::size_t kNoRow = ~std::size_t{0};

  // Direction of a viewing ray, scaled to descend by 1: (x, y, -1).
  struct Ray {
    float x = 0.0f, y = 0.0f;
  };
  struct RenderedPatch {
    PatchShape shape = PatchShape::kSquare;
    float x = 0.0f, y = 0.0f, length = 0.0f, width = 0.0f;
    LinearRgb color{};
  };
  struct Appearance {
    FixedVector<RenderedPatch, kMaxPatches> patches;
  };
  // Position and heading on the floor.
  struct PlanarPose {
    float x = 0.0f, y = 0.0f, cos = 1.0f, sin = 0.0f;
  };
  // A robot, or the ball if `appearance` is null, with its pose at the time of each sample of one row.
  struct Object {
    const Appearance* appearance = nullptr;
    Placement begin, end;
    double turn_rad = 0.0;
    std::size_t row = kNoRow;
    std::array<PlanarPose, kSamples> at{};
  };
  struct Hit {
    float height_m = -1.0f;  // height of the intersection; the highest intersection is the nearest to the camera
    LinearRgb color{};
  };

  void render_floor_once(Floor floor);
  [[nodiscard]] LinearRgb floor_color(float x_m, float y_m, Floor floor) const;
  void add_object(const Appearance* appearance, const Placement& begin, const Placement& end, float radius_m,
                  float height_m);
  void move_to_row(Object& object, std::size_t row) const;
  void render_pixel(std::size_t index, std::uint32_t mask);
  void intersect_robot(const Object& object, int sample, Ray ray, float top_light, Hit& hit) const;
  void intersect_ball(const Object& object, int sample, Ray ray, Hit& hit) const;
  void store_pixel(std::size_t index, const LinearRgb& light);

  const ArenaParameters parameters_;
  std::size_t width_ = 0, height_ = 0;
  Lens lens_;
  Lighting lighting_;
  float half_side_ = 0.0f, robot_height_ = 0.0f, ball_radius_ = 0.0f, white_level_ = 0.0f;
  std::array<float, 3> eye_{};
  LinearRgb body_{}, ball_{}, line_{}, ground_{}, outside_{};
  std::vector<Appearance> appearances_;
  std::vector<Ray> rays_;  // rays through the pixel centers; rays between them are interpolated
  std::vector<float> vignette_;
  std::vector<std::uint16_t> floor_, picture_, dark_;
  std::vector<std::uint32_t> object_mask_;     // for each pixel; bit i: object i may be visible
  std::vector<std::uint32_t> covered_pixels_;  // indices of the pixels with a mask other than 0
  FixedVector<Object, kMaxRobots + 1> objects_;
  RowTiming rows_;
  std::vector<Lighting::Beam> ball_beams_;
};

}  // namespace touchline::hal::mock
