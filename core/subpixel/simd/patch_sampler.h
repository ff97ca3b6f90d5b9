// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

// Number of rows and columns of the grid of sample points on a robot's top.
constexpr int kTopGridSize = 8;
// Distance beyond the robot's edge at which its surroundings are sampled. It lies outside the ramp.
constexpr float kBeyondRobotPx = 2.0f;
// Up to this half size, all pixels of a patch are sampled; of larger ones every second, third, ...
constexpr float kFullPatchReachPx = 16.0f;

inline Float8 u_of(const MarkerView& robot, Float8 x, Float8 y) {
  return broadcast(robot.middle.u_px) + broadcast(robot.u_by_x) * x + broadcast(robot.u_by_y) * y;
}
inline Float8 v_of(const MarkerView& robot, Float8 x, Float8 y) {
  return broadcast(robot.middle.v_px) + broadcast(robot.v_by_x) * x + broadcast(robot.v_by_y) * y;
}

inline ColorSums sample_top(const Frame& frame, const MarkerView& robot) {
  static_assert(kTopGridSize == kLanes);
  const LinearRgbImage picture(frame);
  const Float8 zero = broadcast(0.0f);
  const float inner_m = robot.half_m - 0.6f * robot.ramp_m, apart_m = 2.0f * inner_m / (kTopGridSize - 1);
  const Float8 y = broadcast(-inner_m) + to_floats(iota()) * broadcast(apart_m);
  LinearRgb8 sum{zero, zero, zero};
  int count = 0;
  for (int i = 0; i < kTopGridSize; ++i) {
    const Float8 x = broadcast(apart_m * static_cast<float>(i) - inner_m);
    // With a ramp of twice the width, coverage 0 means that the pixel is clear of the patch.
    Float8 covered = zero;
    for (std::size_t k = 0; k < robot.outlines->size(); ++k) {
      const BlurredOutline& outline = (*robot.outlines)[k];
      const Float8 c = broadcast(outline.cos()), s = broadcast(outline.sin());
      const Float8 from_x = x - broadcast(robot.layout->patches[k].x_m);
      const Float8 from_y = y - broadcast(robot.layout->patches[k].y_m);
      covered += coverage_at(outline, c * from_x + s * from_y, c * from_y - s * from_x, 2.0f * robot.ramp_m).value;
    }
    const Integer8 is_free = covered == zero;
    if (!any(is_free)) continue;
    Integer8 inside;
    const LinearRgb8 light = picture.nearest(u_of(robot, x, y), v_of(robot, x, y), inside);
    count += count_set(inside & is_free);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) sum[c] += select(inside & is_free, light[c]);
  }
  const auto number = static_cast<float>(count);
  return {{number, number, number}, {horizontal_sum(sum[0]), horizontal_sum(sum[1]), horizontal_sum(sum[2])}, {}, {}};
}

// Samples the pixels of one patch.
class PatchSampler {
 public:
  PatchSampler(const Frame& frame, const MarkerView& robot, const PatchView& patch, PatchEdge& edge)
      : frame_(frame),
        picture_(frame),
        robot_(robot),
        patch_(patch),
        place_(robot.layout->patches[patch.number]),
        outline_((*robot.outlines)[patch.number]),
        edge_(edge) {
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) top_[c] = broadcast(robot.top[c]);
  }

  bool sample(ColorSums& inside) {
    edge_.clear();
    if (!with_shape(outline_, [&](const auto& shape) { return sample_shape(shape); })) return false;
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) {
      inside.count[c] = horizontal_sum(count_[c]);
      inside.light[c] = horizontal_sum(sum_[c]);
      inside.squares[c] = horizontal_sum(squares_[c]);
      inside.foreign[c] = horizontal_sum(foreign_[c]);
    }
    return true;
  }

 private:
  template <class Shape>
  bool sample_shape(const Shape& shape) {
    // Jacobian from the outline's axes to pixels, and its inverse.
    const float c = outline_.cos(), s = outline_.sin();
    const float u_by_x = c * robot_.u_by_x + s * robot_.u_by_y, u_by_y = c * robot_.u_by_y - s * robot_.u_by_x;
    const float v_by_x = c * robot_.v_by_x + s * robot_.v_by_y, v_by_y = c * robot_.v_by_y - s * robot_.v_by_x;
    const float determinant = u_by_x * v_by_y - u_by_y * v_by_x;
    const float x_by_u = v_by_y / determinant, x_by_v = -u_by_y / determinant;
    const float y_by_u = -v_by_x / determinant, y_by_v = u_by_x / determinant;
    const FieldPoint box = outline_.half_box(robot_.ramp_m);
    const float reach_u = std::abs(u_by_x) * box.x_m + std::abs(u_by_y) * box.y_m;
    const float reach_v = std::abs(v_by_x) * box.x_m + std::abs(v_by_y) * box.y_m;
    check_robot_edge(box);
    // Ranges of the rows between two parallel sides of a box, and inside the box.
    const auto between_sides = [](float by_u, Float8 at_center, float half) {
      if (std::abs(by_u) * kFarPx < half) {  // parallel to the row
        const Float8 far = select(broadcast(half) >= abs(at_center), broadcast(kFarPx), broadcast(-kFarPx));
        return ColumnRange{broadcast(0.0f) - far, far};
      }
      const Float8 per_u = broadcast(1.0f / by_u);
      const Float8 a = (broadcast(-half) - at_center) * per_u, b = (broadcast(half) - at_center) * per_u;
      return ColumnRange{min(a, b), max(a, b)};
    };
    const auto crossed = [&](Float8 from_v, FieldPoint half) {
      const ColumnRange x = between_sides(x_by_u, broadcast(x_by_v) * from_v, half.x_m),
                        y = between_sides(y_by_u, broadcast(y_by_v) * from_v, half.y_m);
      return ColumnRange{max(x.low, y.low), min(x.high, y.high)};
    };
    const FieldPoint inner = outline_.inner_box(robot_.ramp_m);
    const int stride = sampling_stride(std::max(reach_u, reach_v), kFullPatchReachPx);
    OutlinePixels pixels;
    if (!pixels.collect(
            frame_, patch_.center, reach_v, stride, [&](Float8 from_v) { return crossed(from_v, box); },
            [&](Float8 from_v) {
              return inner.x_m > 0.0f ? crossed(from_v, inner) : ColumnRange{broadcast(1.0f), broadcast(0.0f)};
            })) {
      return false;
    }
    static_cast<void>(pixels.inside().for_each_eight([&](Integer8 u, Integer8 v, Integer8 counts) {
      add_covered(counts, without_top(u, v), measured_at(u, v));
      return true;
    }));
    const float per_m = 1.0f / robot_.ramp_m;
    return pixels.edge().for_each_eight([&](Integer8 u, Integer8 v, Integer8 counts) {
      const Float8 from_u = to_floats(u) - broadcast(patch_.center.u_px);
      const Float8 from_v = to_floats(v) - broadcast(patch_.center.v_px);
      const Float8 x = broadcast(x_by_u) * from_u + broadcast(x_by_v) * from_v;
      const Float8 y = broadcast(y_by_u) * from_u + broadcast(y_by_v) * from_v;
      const Float8 value = shape.at(x, y, per_m).value;
      return add({x, y, without_top(u, v), measured_at(u, v)}, (value > broadcast(0.0f)) & counts,
                 value < broadcast(1.0f));
    });
  }

  // Returns the light of eight pixels minus the light of the robot's top.
  [[nodiscard, gnu::always_inline]] LinearRgb8 without_top(Integer8 u, Integer8 v) const {
    LinearRgb8 light = picture_.at(u, v);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) light[c] -= top_[c];
    return light;
  }

  // Adds pixels that the patch covers completely. `measured`: for each color, a mask of the pixels that measured it.
  [[gnu::always_inline]] void add_covered(Integer8 whole, const LinearRgb8& light,
                                          const std::array<Integer8, 3>& measured) {
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) {
      const Integer8 counts = whole & measured[c];
      const Float8 inner = select(counts, light[c]);
      sum_[c] += inner;
      squares_[c] += inner * inner;
      count_[c] += select(counts, broadcast(1.0f));
    }
  }

  // Eight pixels: positions along the outline's axes, light minus the top's light, and for each color a mask of the
  // pixels that measured it.
  struct Pixels {
    Float8 x, y;
    LinearRgb8 light;
    std::array<Integer8, 3> measured;
  };

  [[nodiscard, gnu::always_inline]] std::array<Integer8, 3> measured_at(Integer8 u, Integer8 v) const {
    const Integer8 zero = broadcast_integer(0), one = broadcast_integer(1);
    if (!robot_.bayer.found) return {~zero, ~zero, ~zero};
    const Integer8 other_column = zero < ((u + broadcast_integer(robot_.bayer.red_column)) & one);
    const Integer8 other_row = zero < ((v + broadcast_integer(robot_.bayer.red_row)) & one);
    return {~(other_column | other_row), other_column ^ other_row, other_column & other_row};
  }

  // Determines whether pixels of the patch can show surroundings beyond the robot's edge.
  void check_robot_edge(FieldPoint box) {
    const float c = outline_.cos(), s = outline_.sin();
    const float wide_x = std::abs(c) * box.x_m + std::abs(s) * box.y_m;
    const float wide_y = std::abs(s) * box.x_m + std::abs(c) * box.y_m;
    reaches_beyond_ =
        std::max(std::abs(place_.x_m) + wide_x, std::abs(place_.y_m) + wide_y) > robot_.half_m - 0.5f * robot_.ramp_m;
  }

  [[gnu::always_inline]] bool add(const Pixels& shown, Integer8 seen, Integer8 in_part) {
    const Integer8 whole = seen & ~in_part, edge = seen & in_part;
    if (any(whole)) add_covered(whole, shown.light, shown.measured);
    if (!any(edge)) return true;
    LinearRgb8 light = shown.light;
    if (edge_.full()) return false;
    edge_.resize(edge_.size() + 1);
    Surroundings around{broadcast(0.0f), edge};
    if (reaches_beyond_) subtract_surroundings(shown.x, shown.y, light, around);
    EdgePixels& pixels = edge_.back();
    store(shown.x, pixels.x);
    store(shown.y, pixels.y);
    store(around.doubt, pixels.doubt);
    Float8 measured = broadcast(1.0f);
    if (robot_.bayer.found) {
      measured += select(shown.measured[1], broadcast(1.0f)) + select(shown.measured[2], broadcast(2.0f));
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) light[c] = select(shown.measured[c], light[c]);
    }
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < 3; ++c) store(light[c], pixels.light[c]);
    store(select(around.counts, measured), pixels.measured);
    return true;
  }

  struct Surroundings {
    Float8 doubt;
    Integer8 counts;
  };

  // Subtracts the light of the surroundings from the part of each pixel beyond the robot's edge. The surroundings are
  // sampled at two distances, because a line may begin or end between them. The larger of both lights determines the
  // doubt.
  [[gnu::always_inline]] void subtract_surroundings(Float8 from_x, Float8 from_y, LinearRgb8& light,
                                                    Surroundings& around) {
    const Float8 c = broadcast(outline_.cos()), s = broadcast(outline_.sin()), half = broadcast(robot_.half_m);
    const Float8 x = broadcast(place_.x_m) + c * from_x - s * from_y;
    const Float8 y = broadcast(place_.y_m) + s * from_x + c * from_y;
    const Float8 beyond_x = abs(x) - half, beyond_y = abs(y) - half;
    const float per_m = 1.0f / robot_.ramp_m;
    const Float8 part = broadcast(1.0f) - EdgeRamp(beyond_x, per_m).value * EdgeRamp(beyond_y, per_m).value;
    const Integer8 affected = part > broadcast(0.0f);
    if (!any(affected & around.counts)) return;
    const LinearRgb8 beside = foreign_light(x, y, robot_.beside_px, part, around);
    const LinearRgb8 beyond = foreign_light(x, y, kBeyondRobotPx, part, around);
    Float8 of_beside = broadcast(0.0f), of_beyond = broadcast(0.0f);
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < 3; ++i) {
      const Float8 near = beside[i] * beside[i], far = beyond[i] * beyond[i];
      light[i] -= beyond[i];
      of_beside += near;
      of_beyond += far;
      foreign_[i] += select(around.counts, max(near, far));
    }
    around.doubt += max(of_beside, of_beyond);
  }

  // Returns the light that the surroundings add to points whose part `part` lies beyond the robot's edge. Samples the
  // surroundings at a distance of `apart_px` from the edge. Excludes points whose sample is outside the picture.
  [[gnu::always_inline]] LinearRgb8 foreign_light(Float8 x, Float8 y, float apart_px, Float8 part,
                                                  Surroundings& around) const {
    const Float8 half = broadcast(robot_.half_m), clear = half + broadcast(apart_px / robot_.scale_px_per_m);
    const Integer8 sideways = abs(x) >= abs(y);
    const Float8 far_x = select(sideways, max(abs(x), clear), min(abs(x), half));
    const Float8 far_y = select(sideways, min(abs(y), half), max(abs(y), clear));
    const Float8 at_x = with_sign(far_x, sign_bit(x)), at_y = with_sign(far_y, sign_bit(y));
    Integer8 inside;
    LinearRgb8 there = picture_.nearest(u_of(robot_, at_x, at_y), v_of(robot_, at_x, at_y), inside);
    around.counts = around.counts & (inside | ~(part > broadcast(0.0f)));
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < 3; ++i) there[i] = part * (there[i] - top_[i]);
    return there;
  }

  static constexpr float kFarPx = 1e4f;

  const Frame& frame_;
  const LinearRgbImage picture_;
  const MarkerView& robot_;
  const PatchView& patch_;
  const PatchPlace& place_;
  const BlurredOutline& outline_;
  PatchEdge& edge_;
  LinearRgb8 top_;
  bool reaches_beyond_ = false;
  LinearRgb8 sum_{broadcast(0.0f), broadcast(0.0f), broadcast(0.0f)};
  LinearRgb8 squares_{broadcast(0.0f), broadcast(0.0f), broadcast(0.0f)};
  LinearRgb8 foreign_{broadcast(0.0f), broadcast(0.0f), broadcast(0.0f)};
  LinearRgb8 count_{broadcast(0.0f), broadcast(0.0f), broadcast(0.0f)};
};

inline bool sample_patch(const Frame& frame, const MarkerView& robot, const PatchView& patch, ColorSums& inside,
                         PatchEdge& edge) {
  return PatchSampler(frame, robot, patch, edge).sample(inside);
}

inline CenterEquations accumulate_edge(const EdgeFitTask& task) {
  const Float8 zero = broadcast(0.0f), one = broadcast(1.0f);
  Float8 xx = zero, xy = zero, yy = zero, rx = zero, ry = zero, squares = zero, weights = zero;
  Float8 widening = zero, wider = zero, xt = zero, yt = zero, tt = zero, rt = zero;
  // Selects the value of the color that each pixel measured.
  const auto of_color = [&](const std::array<float, 3>& value, Float8 measured) {
    if (!task.is_bayer) return broadcast(value[0]);
    return select(measured == one, broadcast(value[0])) + select(measured == broadcast(2.0f), broadcast(value[1])) +
           select(measured == broadcast(3.0f), broadcast(value[2]));
  };
  with_shape(*task.outline, [&](const auto& shape) {
    const float per_m = 1.0f / task.ramp_m;
    for (const EdgePixels& pixels : *task.edge) {
      const Float8 x = load(pixels.x), y = load(pixels.y), measured = load(pixels.measured);
      const Coverage coverage = shape.at(x, y, per_m);
      Float8 error = broadcast(task.along[0]) * load(pixels.light[0]) +
                     broadcast(task.along[1]) * load(pixels.light[1]) +
                     broadcast(task.along[2]) * load(pixels.light[2]) - coverage.value;
      Float8 doubt = one + of_color(task.doubted, measured) * load(pixels.doubt);
      for (const NeighborPatch& other : task.neighbors) {
        const Float8 its_x = broadcast(other.cos) * x - broadcast(other.sin) * y + broadcast(other.x_m);
        const Float8 its_y = broadcast(other.sin) * x + broadcast(other.cos) * y + broadcast(other.y_m);
        const Integer8 near =
            (abs(its_x) < broadcast(other.half_box.x_m)) & (abs(its_y) < broadcast(other.half_box.y_m));
        if (!any(near)) continue;
        const Float8 covered = coverage_at(*other.outline, its_x, its_y, task.ramp_m).value;
        const Float8 light = of_color(other.light, measured);
        error -= light * covered;
        // The error of the neighbor's ramp is largest in the ramp's middle.
        const Float8 ramp = broadcast(4.0f) * light * covered * (one - covered);
        doubt += ramp * ramp;
      }
      const Integer8 flat = (coverage.by_x_m == zero) & (coverage.by_y_m == zero);
      const Float8 counts = task.is_bayer ? of_color(task.weight, measured) : measured;
      const Float8 weight = select(~flat, counts / doubt);
      const Float8 by_x = weight * coverage.by_x_m, by_y = weight * coverage.by_y_m;
      xx += by_x * coverage.by_x_m;
      xy += by_x * coverage.by_y_m;
      yy += by_y * coverage.by_y_m;
      rx += by_x * error;
      ry += by_y * error;
      const Float8 turn = x * coverage.by_y_m - y * coverage.by_x_m;
      xt += by_x * turn;
      yt += by_y * turn;
      tt += weight * turn * turn;
      rt += weight * turn * error;
      squares += weight * error * error;
      weights += weight;
      const Float8 by_width = weight * coverage.by_width;
      widening += by_width * coverage.by_width;
      wider += by_width * error;
    }
  });
  return {horizontal_sum(xx),    horizontal_sum(xy),      horizontal_sum(yy),      horizontal_sum(rx),
          horizontal_sum(ry),    horizontal_sum(squares), horizontal_sum(weights), horizontal_sum(widening),
          horizontal_sum(wider), horizontal_sum(xt),      horizontal_sum(yt),      horizontal_sum(tt),
          horizontal_sum(rt)};
}

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
