#pragma once

#include <algorithm>
#include <cmath>

#include "core/marker/center_kernel.h"
#include "core/marker/cover_lanes.h"
#include "core/marker/linear_picture.h"
#include "core/marker/pixel_rows.h"

namespace touchline {
inline namespace TOUCHLINE_LANES {

// Points a row and rows on a robot's top.
constexpr int kTopGrid = 8;
// How far beyond the robot's edge its surroundings are looked at: clear of the ramp.
constexpr float kBeyondRobotPx = 2.0f;
// Farther from a patch's center every second pixel will do, and so on.
constexpr float kReachOfAllOfPatchPx = 16.0f;

inline Lanes u_of(const MarkerView& robot, Lanes x, Lanes y) {
  return all_lanes(robot.middle.u_px) + all_lanes(robot.u_by_x) * x + all_lanes(robot.u_by_y) * y;
}
inline Lanes v_of(const MarkerView& robot, Lanes x, Lanes y) {
  return all_lanes(robot.middle.v_px) + all_lanes(robot.v_by_x) * x + all_lanes(robot.v_by_y) * y;
}

inline ColorSums see_top(const Frame& frame, const MarkerView& robot) {
  static_assert(kTopGrid == kLanes);
  const LinearPicture picture(frame);
  const Lanes zero = all_lanes(0.0f);
  const float inner_m = robot.half_m - 0.6f * robot.ramp_m, apart_m = 2.0f * inner_m / (kTopGrid - 1);
  const Lanes y = all_lanes(-inner_m) + to_floats(counting()) * all_lanes(apart_m);
  LightLanes sum{zero, zero, zero};
  int count = 0;
  for (int i = 0; i < kTopGrid; ++i) {
    const Lanes x = all_lanes(apart_m * static_cast<float>(i) - inner_m);
    // A ramp twice as wide ends where a pixel is clear of the patch's own.
    Lanes covered = zero;
    for (std::size_t k = 0; k < robot.covers->size(); ++k) {
      const OutlineCover& cover = (*robot.covers)[k];
      const Lanes c = all_lanes(cover.cos()), s = all_lanes(cover.sin());
      const Lanes from_x = x - all_lanes(robot.layout->patches[k].x_m);
      const Lanes from_y = y - all_lanes(robot.layout->patches[k].y_m);
      covered += cover_at(cover, c * from_x + s * from_y, c * from_y - s * from_x, 2.0f * robot.ramp_m).value;
    }
    const LaneIntegers is_free = covered == zero;
    if (!any(is_free)) continue;
    LaneIntegers inside;
    const LightLanes light = picture.nearest(u_of(robot, x, y), v_of(robot, x, y), inside);
    count += count_of(inside & is_free);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) sum[c] += keep(inside & is_free, light[c]);
  }
  return {count, {sum_of(sum[0]), sum_of(sum[1]), sum_of(sum[2])}, 0.0f};
}

// The pixels of one patch.
class PatchEye {
 public:
  PatchEye(const Frame& frame, const MarkerView& robot, const PatchSpot& patch, Edge& edge)
      : frame_(frame),
        picture_(frame),
        robot_(robot),
        patch_(patch),
        place_(robot.layout->patches[patch.number]),
        cover_((*robot.covers)[patch.number]),
        edge_(edge) {
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) top_[c] = all_lanes(robot.top[c]);
  }

  bool look(ColorSums& inside) {
    edge_.clear();
    if (!with_shape(cover_, [&](const auto& shape) { return look_for(shape); })) return false;
    inside = {count_, {sum_of(sum_[0]), sum_of(sum_[1]), sum_of(sum_[2])}, sum_of(squares_)};
    return true;
  }

 private:
  template <class Shape>
  bool look_for(const Shape& shape) {
    // Pixels by the outline's axes, and back.
    const float c = cover_.cos(), s = cover_.sin();
    const float u_by_x = c * robot_.u_by_x + s * robot_.u_by_y, u_by_y = c * robot_.u_by_y - s * robot_.u_by_x;
    const float v_by_x = c * robot_.v_by_x + s * robot_.v_by_y, v_by_y = c * robot_.v_by_y - s * robot_.v_by_x;
    const float determinant = u_by_x * v_by_y - u_by_y * v_by_x;
    const float x_by_u = v_by_y / determinant, x_by_v = -u_by_y / determinant;
    const float y_by_u = -v_by_x / determinant, y_by_v = u_by_x / determinant;
    const FieldPoint box = cover_.half_box(robot_.ramp_m);
    const float reach_u = std::abs(u_by_x) * box.x_m + std::abs(u_by_y) * box.y_m;
    const float reach_v = std::abs(v_by_x) * box.x_m + std::abs(v_by_y) * box.y_m;
    find_reach(box);
    // Where rows are between two parallel sides of a box, and in the box.
    const auto between_sides = [](float by_u, Lanes at_center, float half) {
      if (std::abs(by_u) * kFarPx < half) return Columns{all_lanes(-kFarPx), all_lanes(kFarPx)};
      const Lanes per_u = all_lanes(1.0f / by_u);
      const Lanes a = (all_lanes(-half) - at_center) * per_u, b = (all_lanes(half) - at_center) * per_u;
      return Columns{smaller(a, b), larger(a, b)};
    };
    const auto crossed = [&](Lanes from_v, FieldPoint half) {
      const Columns x = between_sides(x_by_u, all_lanes(x_by_v) * from_v, half.x_m),
                    y = between_sides(y_by_u, all_lanes(y_by_v) * from_v, half.y_m);
      return Columns{larger(x.low, y.low), smaller(x.high, y.high)};
    };
    const FieldPoint inner = cover_.inner_box(robot_.ramp_m);
    const int stride = stride_of(std::max(reach_u, reach_v), kReachOfAllOfPatchPx);
    OutlinePixels pixels;
    if (!pixels.collect(
            frame_, patch_.center, reach_v, stride, [&](Lanes from_v) { return crossed(from_v, box); },
            [&](Lanes from_v) {
              return inner.x_m > 0.0f ? crossed(from_v, inner) : Columns{all_lanes(1.0f), all_lanes(0.0f)};
            })) {
      return false;
    }
    const float per_m = 1.0f / robot_.ramp_m;
    return pixels.for_each_eight([&](LaneIntegers u, LaneIntegers v, LaneIntegers counts) {
      const Lanes from_u = to_floats(u) - all_lanes(patch_.center.u_px);
      const Lanes from_v = to_floats(v) - all_lanes(patch_.center.v_px);
      const Lanes x = all_lanes(x_by_u) * from_u + all_lanes(x_by_v) * from_v;
      const Lanes y = all_lanes(y_by_u) * from_u + all_lanes(y_by_v) * from_v;
      const Lanes value = shape.at(x, y, per_m).value;
      return add(x + all_lanes(patch_.at.x_m), y + all_lanes(patch_.at.y_m), picture_.at(u, v),
                 (value > all_lanes(0.0f)) & counts, value < all_lanes(1.0f));
    });
  }

  // May a pixel of the patch show what is beyond the robot's edge?
  void find_reach(FieldPoint box) {
    const float c = cover_.cos(), s = cover_.sin();
    const float x = place_.x_m + c * patch_.at.x_m - s * patch_.at.y_m;
    const float y = place_.y_m + s * patch_.at.x_m + c * patch_.at.y_m;
    const float wide_x = std::abs(c) * box.x_m + std::abs(s) * box.y_m;
    const float wide_y = std::abs(s) * box.x_m + std::abs(c) * box.y_m;
    reaches_beyond_ = std::max(std::abs(x) + wide_x, std::abs(y) + wide_y) > robot_.half_m - 0.5f * robot_.ramp_m;
  }

  [[gnu::always_inline]] bool add(Lanes x, Lanes y, const LightLanes& shown, LaneIntegers seen, LaneIntegers in_part) {
    const LaneIntegers whole = seen & ~in_part, edge = seen & in_part;
    LightLanes light = shown;
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) light[c] -= top_[c];
    if (any(whole)) {
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) {
        const Lanes inner = keep(whole, light[c]);
        sum_[c] += inner;
        squares_ += inner * inner;
      }
      count_ += count_of(whole);
    }
    if (!any(edge)) return true;
    if (edge_.full()) return false;
    edge_.resize(edge_.size() + 1);
    Surroundings around{all_lanes(0.0f), edge};
    if (reaches_beyond_) take_out_surroundings(x, y, light, around);
    EdgePixels& pixels = edge_.back();
    store(x, pixels.x);
    store(y, pixels.y);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) store(light[c], pixels.light[c]);
    store(around.doubt, pixels.doubt);
    store(keep(around.counts, all_lanes(1.0f)), pixels.counts);
    return true;
  }

  struct Surroundings {
    Lanes doubt;
    LaneIntegers counts;
  };

  // The part of a pixel that is beyond the robot's edge shows what is seen there.
  [[gnu::always_inline]] void take_out_surroundings(Lanes from_x, Lanes from_y, LightLanes& light,
                                                    Surroundings& around) const {
    const Lanes c = all_lanes(cover_.cos()), s = all_lanes(cover_.sin()), half = all_lanes(robot_.half_m);
    const Lanes x = all_lanes(place_.x_m) + c * from_x - s * from_y;
    const Lanes y = all_lanes(place_.y_m) + s * from_x + c * from_y;
    const Lanes beyond_x = absolute(x) - half, beyond_y = absolute(y) - half;
    const float per_m = 1.0f / robot_.ramp_m;
    const Lanes part = all_lanes(1.0f) - EdgeRamp(beyond_x, per_m).value * EdgeRamp(beyond_y, per_m).value;
    const LaneIntegers concerned = part > all_lanes(0.0f);
    if (!any(concerned & around.counts)) return;
    const Lanes clear = all_lanes(robot_.half_m + kBeyondRobotPx / robot_.scale_px_per_m);
    const LaneIntegers sideways = beyond_x >= beyond_y;
    const Lanes far_x = choose(sideways, larger(absolute(x), clear), smaller(absolute(x), half));
    const Lanes far_y = choose(sideways, smaller(absolute(y), half), larger(absolute(y), clear));
    const Lanes at_x = with_sign(far_x, sign_of(x)), at_y = with_sign(far_y, sign_of(y));
    LaneIntegers inside;
    const LightLanes there = picture_.nearest(u_of(robot_, at_x, at_y), v_of(robot_, at_x, at_y), inside);
    around.counts = around.counts & (inside | ~concerned);
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < 3; ++i) {
      const Lanes foreign = part * (there[i] - top_[i]);
      light[i] -= foreign;
      around.doubt += foreign * foreign;
    }
  }

  static constexpr float kFarPx = 1e4f;

  const Frame& frame_;
  const LinearPicture picture_;
  const MarkerView& robot_;
  const PatchSpot& patch_;
  const PatchPlace& place_;
  const OutlineCover& cover_;
  Edge& edge_;
  LightLanes top_;
  bool reaches_beyond_ = false;
  LightLanes sum_{all_lanes(0.0f), all_lanes(0.0f), all_lanes(0.0f)};
  Lanes squares_ = all_lanes(0.0f);
  int count_ = 0;
};

inline bool see_patch(const Frame& frame, const MarkerView& robot, const PatchSpot& patch, ColorSums& inside,
                      Edge& edge) {
  return PatchEye(frame, robot, patch, edge).look(inside);
}

inline EdgeSums fit_edge(const EdgeTask& task) {
  const Lanes zero = all_lanes(0.0f), one = all_lanes(1.0f);
  Lanes xx = zero, xy = zero, yy = zero, rx = zero, ry = zero, squares = zero, weights = zero;
  const Lanes doubted = all_lanes(task.doubted);
  with_shape(*task.cover, [&](const auto& shape) {
    const float per_m = 1.0f / task.ramp_m;
    for (const EdgePixels& pixels : *task.edge) {
      const Lanes x = load(pixels.x), y = load(pixels.y);
      const Cover cover = shape.at(x - all_lanes(task.at.x_m), y - all_lanes(task.at.y_m), per_m);
      Lanes error = all_lanes(task.along[0]) * load(pixels.light[0]) +
                    all_lanes(task.along[1]) * load(pixels.light[1]) +
                    all_lanes(task.along[2]) * load(pixels.light[2]) - cover.value;
      for (const NeighborPatch& other : task.neighbors) {
        const Lanes its_x = all_lanes(other.cos) * x - all_lanes(other.sin) * y + all_lanes(other.x_m);
        const Lanes its_y = all_lanes(other.sin) * x + all_lanes(other.cos) * y + all_lanes(other.y_m);
        const LaneIntegers near =
            (absolute(its_x) < all_lanes(other.half_box.x_m)) & (absolute(its_y) < all_lanes(other.half_box.y_m));
        if (any(near)) error -= all_lanes(other.light) * cover_at(*other.cover, its_x, its_y, task.ramp_m).value;
      }
      const LaneIntegers flat = (cover.by_x_m == zero) & (cover.by_y_m == zero);
      const Lanes weight = keep(~flat, load(pixels.counts) / (one + doubted * load(pixels.doubt)));
      const Lanes by_x = weight * cover.by_x_m, by_y = weight * cover.by_y_m;
      xx += by_x * cover.by_x_m;
      xy += by_x * cover.by_y_m;
      yy += by_y * cover.by_y_m;
      rx += by_x * error;
      ry += by_y * error;
      squares += weight * error * error;
      weights += weight;
    }
  });
  return {sum_of(xx), sum_of(xy), sum_of(yy), sum_of(rx), sum_of(ry), sum_of(squares), sum_of(weights)};
}

}  // namespace TOUCHLINE_LANES
}  // namespace touchline
