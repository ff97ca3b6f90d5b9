// Part of simd/kernel_functions.h, which includes it once for each instruction set: no include guard, no #include.

namespace touchline {
namespace TOUCHLINE_SIMD {

// Distance beyond the ramp at which the surroundings are sampled, so that the nearest pixel shows nothing of the ball.
constexpr float kBeyondRampPx = 1.0f;
// Up to this radius, all pixels of the ball are sampled; of a larger ball every second, third, ...
constexpr float kFullBallReachPx = 18.0f;
// Least light of a saturated channel. It is a lower bound of the surface's light.
constexpr float kSaturation = 0.98f;
// Surface normals are limited to this radius, because their derivative diverges at the outline.
constexpr float kMaxNormalRadius = 0.98f;

// Squared difference from the candidate surroundings, relative to the largest one, at which a sample counts half.
constexpr float kOtherSurroundings = 0.02f;
// Surroundings with a smaller squared difference from the most frequent ones count as equal to them.
constexpr float kSameSurroundings = 0.004f;
// Weight of a squared error that wrong surroundings may cause, relative to a squared residual. The error counts less
// below kNegligibleDoubt times the squared residual at which the weight is one half.
constexpr float kDoubtWeight = 64.0f, kNegligibleDoubt = 1.0f;

// Returns the pixels whose viewing ray meets a robot above the ball: slab test of Kay and Kajiya (1986) between the
// robot's top and the height of the ball.
inline Integer8 hidden_by(const BallView& ball, Float8 u, Float8 v) {
  Integer8 hidden = broadcast_integer(0);
  for (const HidingTop& top : ball.tops) {
    const Float8 from_u = u - broadcast(top.center.u_px), from_v = v - broadcast(top.center.v_px);
    const Float8 x = broadcast(top.inverse[0]) * from_u + broadcast(top.inverse[1]) * from_v;
    const Float8 y = broadcast(top.inverse[2]) * from_u + broadcast(top.inverse[3]) * from_v;
    Float8 enter = broadcast(0.0f), leave = broadcast(1.0f);
    const auto cross = [&](Float8 from, float reach, float per_fall) {
      const Float8 near = (broadcast(-reach) - from) * broadcast(per_fall);
      const Float8 far = (broadcast(reach) - from) * broadcast(per_fall);
      enter = max(enter, min(near, far));
      leave = min(leave, max(near, far));
    };
    cross(x, top.reach_x, top.per_fall_x);
    cross(y, top.reach_y, top.per_fall_y);
    hidden = hidden | (enter < leave);
  }
  return hidden;
}

// Radius at which the surroundings are sampled, in radii of the ball.
inline float sampled_radius(const BallView& ball) {
  return 1.0f + (0.5f * ball.ramp_px + kBeyondRampPx) / ball.radius_px;
}

// Subtracts the surroundings' light from eight outline pixels. Also finds the error of the result from the error of
// this light.
inline void subtract_surroundings_of_ball(BallPixels& pixels) {
  const Float8 part = broadcast(1.0f) - load(pixels.coverage);
  TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
    store(load(pixels.light[c]) - part * load(pixels.outside[c]), pixels.rest[c]);
  }
  store(part * part * load(pixels.apart2), pixels.doubt);
}

// Computes the values of eight sampled pixels that depend on the ball's center.
[[gnu::always_inline]] inline void cover(const BallView& ball, BallPixels& pixels) {
  const Float8 zero = broadcast(0.0f), one = broadcast(1.0f);
  const std::array<float, 4>& inverse = ball.inverse;
  const Float8 from_u = load(pixels.u) - broadcast(ball.center.u_px);
  const Float8 from_v = load(pixels.v) - broadcast(ball.center.v_px);
  const Float8 x = broadcast(inverse[0]) * from_u + broadcast(inverse[1]) * from_v;
  const Float8 y = broadcast(inverse[2]) * from_u + broadcast(inverse[3]) * from_v;
  const Float8 r = sqrt(x * x + y * y), per_r = one / max(r, broadcast(1e-6f));
  const Float8 counts = load(pixels.counts);
  const Float8 coverage =
      counts * clamp_to_unit(broadcast(0.5f) - (r - one) * broadcast(ball.radius_px / ball.ramp_px));
  const Float8 shrunk = min(one, broadcast(kMaxNormalRadius) * per_r);
  const Float8 nx = shrunk * x, ny = shrunk * y;
  store(coverage, pixels.coverage);
  store(coverage * nx, pixels.slopes[0]);
  store(coverage * ny, pixels.slopes[1]);
  store(coverage * sqrt(max(one - nx * nx - ny * ny, zero)), pixels.slopes[2]);
  if (!pixels.on_edge) {
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) pixels.rest[c] = pixels.light[c];
    return;
  }
  const Float8 out = select((coverage > zero) & (coverage < one), per_r);
  store(out * x, pixels.out_x);
  store(out * y, pixels.out_y);
  subtract_surroundings_of_ball(pixels);
}

// Returns the squared difference of each pixel's surroundings from a light.
inline Float8 surroundings_distance2(const BallPixels& pixels, const std::array<float, kLightChannels>& light) {
  Float8 sum = broadcast(0.0f);
  TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
    const Float8 difference = load(pixels.outside[c]) - broadcast(light[c]);
    sum += difference * difference;
  }
  return sum;
}

inline Integer8 is_on_outline(const BallPixels& pixels) {
  const Float8 x = load(pixels.out_x), y = load(pixels.out_y);
  return x * x + y * y > broadcast(0.5f);
}

// Finds the most frequent light of the surroundings, which is assumed to be near the darkest or the brightest sample
// around the ball. False if the ball has no outline.
inline bool find_most_frequent(const BallDisk& disk, std::array<float, kLightChannels>& most) {
  const Float8 zero = broadcast(0.0f);
  using Light = std::array<float, kLightChannels>;
  // The darkest and the brightest sample of each lane, then of all lanes.
  std::array<Float8, 2> sums{broadcast(1e9f), broadcast(-1.0f)};
  std::array<LinearRgb8, 2> lights{};
  for (const BallPixels& pixels : disk) {
    if (!pixels.on_edge) continue;
    const LinearRgb8 light{load(pixels.outside[0]), load(pixels.outside[1]), load(pixels.outside[2])};
    const Float8 sum = light[0] + light[1] + light[2];
    const Integer8 edge = is_on_outline(pixels);
    const std::array<Integer8, 2> beyond{edge & (sum < sums[0]), edge & (sum > sums[1])};
    TOUCHLINE_UNROLL for (std::size_t end = 0; end < 2; ++end) {
      sums[end] = select(beyond[end], sum, sums[end]);
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
        lights[end][c] = select(beyond[end], light[c], lights[end][c]);
      }
    }
  }
  std::array<Light, 2> ends{};
  std::array<float, 2> extreme{};
  for (std::size_t end = 0; end < 2; ++end) {
    StoredFloat8 sum, channel;
    store(sums[end], sum);
    const auto& value = sum.value;
    const auto* const at =
        end == 0 ? std::min_element(value.begin(), value.end()) : std::max_element(value.begin(), value.end());
    extreme[end] = *at;
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      store(lights[end][c], channel);
      ends[end][c] = channel.value[static_cast<std::size_t>(at - value.begin())];
    }
  }
  if (extreme[1] < extreme[0]) return false;
  float apart2 = 1e-6f;
  for (std::size_t c = 0; c < kLightChannels; ++c) apart2 += (ends[1][c] - ends[0][c]) * (ends[1][c] - ends[0][c]);
  const Float8 scale2 = broadcast(kOtherSurroundings * apart2);
  std::array<float, 2> count{};
  std::array<Light, 2> mean{};
  for (std::size_t end = 0; end < 2; ++end) {
    Float8 weights = zero;
    LinearRgb8 sum{zero, zero, zero};
    for (const BallPixels& pixels : disk) {
      if (!pixels.on_edge) continue;
      const Float8 weight =
          select(is_on_outline(pixels), scale2 / (scale2 + surroundings_distance2(pixels, ends[end])));
      weights += weight;
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) sum[c] += weight * load(pixels.outside[c]);
    }
    count[end] = horizontal_sum(weights);
    for (std::size_t c = 0; c < kLightChannels; ++c) mean[end][c] = horizontal_sum(sum[c]) / count[end];
  }
  most = count[1] > count[0] ? mean[1] : mean[0];
  return true;
}

// Improves the light of the surroundings under outline pixels, and estimates its error. Where the light just outside of
// a pixel differs from the most frequent one, a line, a wall or a robot begins somewhere under the pixel. Lines and
// walls are parallel to the field's axes. If the light is equal on both sides of the ball along one axis, the light
// between is interpolated.
inline void follow_lines(const LinearRgbImage& picture, const BallView& ball, BallDisk& disk) {
  std::array<float, kLightChannels> most{};
  if (!find_most_frequent(disk, most)) return;
  const Float8 zero = broadcast(0.0f);
  const float beyond = sampled_radius(ball);
  const std::array<float, 4>& inverse = ball.inverse;
  for (BallPixels& pixels : disk) {
    if (!pixels.on_edge) continue;
    Float8 least = surroundings_distance2(pixels, most);
    store(least, pixels.apart2);
    if (!any(least > broadcast(kSameSurroundings))) {
      subtract_surroundings_of_ball(pixels);
      continue;
    }
    const Float8 from_u = load(pixels.u) - broadcast(ball.center.u_px);
    const Float8 from_v = load(pixels.v) - broadcast(ball.center.v_px);
    const Float8 x = broadcast(inverse[0]) * from_u + broadcast(inverse[1]) * from_v;
    const Float8 y = broadcast(inverse[2]) * from_u + broadcast(inverse[3]) * from_v;
    LinearRgb8 light{load(pixels.outside[0]), load(pixels.outside[1]), load(pixels.outside[2])};
    for (const std::array<float, 2>& axis : ball.lines) {
      const Float8 along = broadcast(axis[0]) * x + broadcast(axis[1]) * y;
      const Float8 wide = sqrt(max(broadcast(beyond * beyond) - (x * x + y * y - along * along), zero));
      std::array<LinearRgb8, 2> end;
      const std::array<Float8, 2> way{wide - along, zero - wide - along};
      Integer8 both = wide > zero;
      for (std::size_t i = 0; i < 2; ++i) {
        const Float8 at_x = x + way[i] * broadcast(axis[0]), at_y = y + way[i] * broadcast(axis[1]);
        const Float8 u =
            broadcast(ball.center.u_px) + broadcast(ball.axis[0].u_px) * at_x + broadcast(ball.axis[1].u_px) * at_y;
        const Float8 v =
            broadcast(ball.center.v_px) + broadcast(ball.axis[0].v_px) * at_x + broadcast(ball.axis[1].v_px) * at_y;
        Integer8 inside;
        end[i] = picture.nearest(u, v, inside);
        both = both & inside;
        if (!ball.tops.empty()) both = both & ~hidden_by(ball, u, v);
      }
      Float8 apart2 = zero;
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
        apart2 += (end[0][c] - end[1][c]) * (end[0][c] - end[1][c]);
      }
      const Integer8 better = both & (apart2 < least);
      const Float8 first = (zero - way[1]) / (way[0] - way[1]);
      least = select(better, apart2, least);
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
        light[c] = select(better, end[1][c] + first * (end[0][c] - end[1][c]), light[c]);
      }
    }
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) store(light[c], pixels.outside[c]);
    store(least, pixels.apart2);
    subtract_surroundings_of_ball(pixels);
  }
}

inline bool sample_ball(const Frame& frame, const BallView& ball, BallDisk& disk) {
  const LinearRgbImage picture(frame);
  const Float8 zero = broadcast(0.0f), one = broadcast(1.0f);
  const std::array<float, 4>& inverse = ball.inverse;
  disk.clear();
  const float reach = 1.0f + (0.5f * ball.ramp_px + kKeptSamplesPx) / ball.radius_px;
  const float reach_u = reach * std::hypot(ball.axis[0].u_px, ball.axis[1].u_px);
  const float reach_v = reach * std::hypot(ball.axis[0].v_px, ball.axis[1].v_px);
  // Within a row, the squared distance from the center is a quadratic function of the column.
  const float square = inverse[0] * inverse[0] + inverse[2] * inverse[2];
  const auto crossed = [&](Float8 from_v, float radius) {
    const Float8 x = broadcast(inverse[1]) * from_v, y = broadcast(inverse[3]) * from_v, per = broadcast(1.0f / square);
    const Float8 half = (broadcast(inverse[0]) * x + broadcast(inverse[2]) * y) * per;
    const Float8 rest = half * half - (x * x + y * y - broadcast(radius * radius)) * per;
    const Integer8 is_crossed = rest >= zero;
    const Float8 wide = sqrt(max(rest, zero));
    return ColumnRange{select(is_crossed, zero - half - wide, one), select(is_crossed, wide - half, zero)};
  };
  const int stride = sampling_stride(std::max(reach_u, reach_v), kFullBallReachPx);
  OutlinePixels pixels_of_ball;
  if (!pixels_of_ball.collect(
          frame, ball.center, reach_v, stride, [&](Float8 from_v) { return crossed(from_v, reach); },
          [&](Float8 from_v) { return crossed(from_v, std::max(0.0f, 2.0f - reach)); })) {
    return false;
  }
  const auto add = [&](Integer8 u, Integer8 v, Integer8 counts) {
    const Float8 from_u = to_floats(u) - broadcast(ball.center.u_px);
    const Float8 from_v = to_floats(v) - broadcast(ball.center.v_px);
    const Float8 x = broadcast(inverse[0]) * from_u + broadcast(inverse[1]) * from_v;
    const Float8 y = broadcast(inverse[2]) * from_u + broadcast(inverse[3]) * from_v;
    const Float8 r = sqrt(x * x + y * y);
    // 1 or more: completely covered. 0 or more: on the outline. Both have a margin for the motion of the ball.
    const Float8 depth = broadcast(0.5f) - (r - one) * broadcast(ball.radius_px / ball.ramp_px);
    const float may_move = kKeptSamplesPx / ball.ramp_px;
    counts = counts & (depth > broadcast(-may_move));
    if (!ball.tops.empty()) counts = counts & ~hidden_by(ball, to_floats(u), to_floats(v));
    if (!any(counts)) return true;
    if (disk.full()) return false;
    disk.resize(disk.size() + 1);
    BallPixels& pixels = disk.back();
    const LinearRgb8 light = picture.at(u, v);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      store(light[c], pixels.light[c]);
      store(select(light[c] >= broadcast(kSaturation), broadcast(1e9f), broadcast(-1e9f)), pixels.up_to[c]);
    }
    const Integer8 edge = counts & (depth < broadcast(1.0f + may_move));
    pixels.on_edge = any(edge);
    store(zero, pixels.doubt);
    store(zero, pixels.apart2);
    if (pixels.on_edge) {
      const Float8 beyond = broadcast(sampled_radius(ball)) / max(r, broadcast(1e-6f));
      const Float8 beyond_x = beyond * x, beyond_y = beyond * y;
      const Float8 beyond_u = broadcast(ball.center.u_px) + broadcast(ball.axis[0].u_px) * beyond_x +
                              broadcast(ball.axis[1].u_px) * beyond_y;
      const Float8 beyond_v = broadcast(ball.center.v_px) + broadcast(ball.axis[0].v_px) * beyond_x +
                              broadcast(ball.axis[1].v_px) * beyond_y;
      Integer8 inside;
      const LinearRgb8 outside = picture.nearest(beyond_u, beyond_v, inside);
      if (!ball.tops.empty()) inside = inside & ~hidden_by(ball, beyond_u, beyond_v);
      counts = counts & (inside | ~edge);
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) store(outside[c], pixels.outside[c]);
    }
    store(to_floats(u), pixels.u);
    store(to_floats(v), pixels.v);
    store(select(counts, one), pixels.counts);
    cover(ball, pixels);
    return true;
  };
  const bool is_collected = pixels_of_ball.edge().for_each_eight(add) && pixels_of_ball.inside().for_each_eight(add);
  if (is_collected) follow_lines(picture, ball, disk);
  return is_collected;
}

inline void move_ball(const BallView& ball, BallDisk& disk) {
  for (BallPixels& pixels : disk) {
    cover(ball, pixels);
  }
}

/// Eight pixels of the ball compared with the shading model.
struct ShadedPixels {
  std::array<Float8, kShadeTerms> terms;  // w and w n
  LinearRgb8 model, error;                // error: measured light minus the model
  LinearRgb8 rest;
  Float8 weight, fitting;  // fitting: the weight by the error alone

  ShadedPixels(const BallPixels& pixels, const BallShading& shading)
      : terms{load(pixels.coverage), load(pixels.slopes[0]), load(pixels.slopes[1]), load(pixels.slopes[2])} {
    Float8 square = broadcast(0.0f);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      const std::array<float, kShadeTerms>& of = shading.of[c];
      model[c] = (broadcast(of[0]) * terms[0] + broadcast(of[1]) * terms[1]) +
                 (broadcast(of[2]) * terms[2] + broadcast(of[3]) * terms[3]);
      // A saturated channel has no negative error: its true light may be as large as the model's.
      rest[c] = max(load(pixels.rest[c]), min(model[c], load(pixels.up_to[c])));
      error[c] = rest[c] - model[c];
      square += error[c] * error[c];
    }
    const Float8 allowed = broadcast(shading.allowed);
    fitting = allowed / (allowed + square);
    weight = fitting;
    if (!pixels.on_edge) return;
    const Float8 doubt = load(pixels.doubt);
    const Float8 counted = doubt * doubt / (doubt + broadcast(kNegligibleDoubt) * allowed);
    weight = allowed / (allowed + square + broadcast(kDoubtWeight) * counted);
  }
};

inline ShadingEquations accumulate_shading(const BallDisk& disk, const BallShading& before) {
  const Float8 zero = broadcast(0.0f);
  std::array<std::array<Float8, kShadeTerms>, kShadeTerms> normal;
  std::array<std::array<Float8, kShadeTerms>, kLightChannels> right;
  for (auto& row : normal) row.fill(zero);
  for (auto& row : right) row.fill(zero);
  Float8 fitting = zero, weighted = zero, covered = zero;
  for (const BallPixels& stored : disk) {
    const ShadedPixels pixels(stored, before);
    fitting += pixels.fitting * pixels.terms[0];
    weighted += pixels.weight * pixels.terms[0];
    covered += pixels.terms[0];
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
      const Float8 term = pixels.weight * pixels.terms[i];
      TOUCHLINE_UNROLL for (std::size_t j = 0; j <= i; ++j) normal[i][j] += term * pixels.terms[j];
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) right[c][i] += term * pixels.rest[c];
    }
  }
  ShadingEquations sums;
  sums.fitting = horizontal_sum(fitting);
  sums.weighted = horizontal_sum(weighted);
  sums.covered = horizontal_sum(covered);
  TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
    TOUCHLINE_UNROLL for (std::size_t j = 0; j <= i; ++j) sums.normal[i][j] = horizontal_sum(normal[i][j]);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) sums.right[c][i] = horizontal_sum(right[c][i]);
  }
  return sums;
}

inline BallOutlineEquations accumulate_outline(const BallDisk& disk, const BallShading& shading, const BallView& ball) {
  const Float8 zero = broadcast(0.0f), steepness = broadcast(ball.radius_px / ball.ramp_px);
  Float8 xx = zero, xy = zero, yy = zero, rx = zero, ry = zero;
  Float8 pull_xx = zero, pull_xy = zero, pull_yy = zero;
  Float8 ramp_power = zero, ramp_pull = zero;
  std::array<std::array<Float8, kShadeTerms>, kLightChannels> shared_x, shared_y;
  for (auto& row : shared_x) row.fill(zero);
  for (auto& row : shared_y) row.fill(zero);
  for (const BallPixels& stored : disk) {
    if (!stored.on_edge) continue;
    const ShadedPixels pixels(stored, shading);
    const Float8 coverage = pixels.terms[0];
    const Float8 whole = broadcast(1.0f) / max(coverage, broadcast(1e-6f));
    const Float8 out_x = load(stored.out_x), out_y = load(stored.out_y);
    const Float8 weight_x = pixels.weight * out_x, weight_y = pixels.weight * out_y;
    Float8 power = zero, along = zero;
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      const Float8 change = (pixels.model[c] * whole - load(stored.outside[c])) * steepness;
      power += change * change;
      along += change * pixels.error[c];
      const Float8 by_x = weight_x * change, by_y = weight_y * change;
      TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
        shared_x[c][i] += by_x * pixels.terms[i];
        shared_y[c][i] += by_y * pixels.terms[i];
      }
    }
    xx += weight_x * power * out_x;
    xy += weight_x * power * out_y;
    yy += weight_y * power * out_y;
    const Float8 pull_x = weight_x * along, pull_y = weight_y * along;
    rx += pull_x;
    ry += pull_y;
    pull_xx += pull_x * pull_x;
    pull_xy += pull_x * pull_y;
    pull_yy += pull_y * pull_y;
    const Float8 widened = select(is_on_outline(stored), pixels.weight * (broadcast(0.5f) - coverage));
    ramp_pull += widened * along;
    ramp_power += widened * (broadcast(0.5f) - coverage) * power;
  }
  BallOutlineEquations sums;
  sums.edge = {
      horizontal_sum(xx), horizontal_sum(xy), horizontal_sum(yy), horizontal_sum(rx), horizontal_sum(ry), 0.0f, 0.0f};
  TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
      sums.shared_x[c][i] = horizontal_sum(shared_x[c][i]);
      sums.shared_y[c][i] = horizontal_sum(shared_y[c][i]);
    }
  }
  sums.pull_xx = horizontal_sum(pull_xx);
  sums.pull_xy = horizontal_sum(pull_xy);
  sums.pull_yy = horizontal_sum(pull_yy);
  sums.ramp_pull = horizontal_sum(ramp_pull);
  sums.ramp_power = horizontal_sum(ramp_power);
  return sums;
}

}  // namespace TOUCHLINE_SIMD
}  // namespace touchline
