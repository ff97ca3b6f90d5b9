#pragma once

#include <algorithm>
#include <cmath>

#include "core/marker/center_kernel.h"
#include "core/marker/linear_picture.h"
#include "core/marker/pixel_rows.h"

namespace touchline {
inline namespace TOUCHLINE_LANES {

// How far beyond its outline what surrounds the ball is looked at: where the ramp has ended.
constexpr float kBeyondBallPx = 2.25f;
// Farther from its center every second pixel will do, and so on.
constexpr float kReachOfAllOfBallPx = 18.0f;
// Light from which on a channel is cut off, or nearly: the surface is so bright there, or brighter.
constexpr float kCutOff = 0.98f;
// The direction of the surface at the outline itself has no slope that a fit could use.
constexpr float kOutermost = 0.98f;

inline bool see_ball(const Frame& frame, const BallView& ball, Disk& disk) {
  const LinearPicture picture(frame);
  const Lanes zero = all_lanes(0.0f), one = all_lanes(1.0f);
  const std::array<float, 4>& inverse = ball.inverse;
  disk.clear();
  const float reach = 1.0f + 0.5f * kRampPx / ball.radius_px;
  const float reach_u = reach * std::hypot(ball.axis[0].u_px, ball.axis[1].u_px);
  const float reach_v = reach * std::hypot(ball.axis[0].v_px, ball.axis[1].v_px);
  // Of a row, x and y are sums of a part by column and one by row: their squares' sum is a parabola.
  const float square = inverse[0] * inverse[0] + inverse[2] * inverse[2];
  const auto crossed = [&](Lanes from_v, float radius) {
    const Lanes x = all_lanes(inverse[1]) * from_v, y = all_lanes(inverse[3]) * from_v, per = all_lanes(1.0f / square);
    const Lanes half = (all_lanes(inverse[0]) * x + all_lanes(inverse[2]) * y) * per;
    const Lanes rest = half * half - (x * x + y * y - all_lanes(radius * radius)) * per;
    const LaneIntegers is_crossed = rest >= zero;
    const Lanes wide = root(larger(rest, zero));
    return Columns{choose(is_crossed, zero - half - wide, one), choose(is_crossed, wide - half, zero)};
  };
  const int stride = stride_of(std::max(reach_u, reach_v), kReachOfAllOfBallPx);
  OutlinePixels pixels_of_ball;
  if (!pixels_of_ball.collect(
          frame, ball.center, reach_v, stride, [&](Lanes from_v) { return crossed(from_v, reach); },
          [&](Lanes from_v) { return crossed(from_v, std::max(0.0f, 2.0f - reach)); })) {
    return false;
  }
  return pixels_of_ball.for_each_eight([&](LaneIntegers u, LaneIntegers v, LaneIntegers counts) {
    const Lanes from_u = to_floats(u) - all_lanes(ball.center.u_px);
    const Lanes from_v = to_floats(v) - all_lanes(ball.center.v_px);
    const Lanes x = all_lanes(inverse[0]) * from_u + all_lanes(inverse[1]) * from_v;
    const Lanes y = all_lanes(inverse[2]) * from_u + all_lanes(inverse[3]) * from_v;
    const Lanes r = root(x * x + y * y), per_r = one / larger(r, all_lanes(1e-6f));
    const Lanes cover = smaller(one, all_lanes(0.5f) - (r - one) * all_lanes(ball.radius_px / kRampPx));
    counts = counts & (cover > zero);
    if (!any(counts)) return true;
    if (disk.full()) return false;
    disk.resize(disk.size() + 1);
    DiskPixels& pixels = disk.back();
    LightLanes rest = picture.at(u, v);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      store(choose(rest[c] >= all_lanes(kCutOff), all_lanes(1e9f), all_lanes(-1e9f)), pixels.up_to[c]);
    }
    const LaneIntegers edge = counts & (cover < one);
    pixels.on_edge = any(edge);
    if (pixels.on_edge) {
      const Lanes beyond = per_r * all_lanes(1.0f + kBeyondBallPx / ball.radius_px);
      const Lanes beyond_x = beyond * x, beyond_y = beyond * y;
      LaneIntegers inside;
      const LightLanes light = picture.nearest(all_lanes(ball.center.u_px) + all_lanes(ball.axis[0].u_px) * beyond_x +
                                                   all_lanes(ball.axis[1].u_px) * beyond_y,
                                               all_lanes(ball.center.v_px) + all_lanes(ball.axis[0].v_px) * beyond_x +
                                                   all_lanes(ball.axis[1].v_px) * beyond_y,
                                               inside);
      counts = counts & (inside | ~edge);
      store(keep(edge & counts, per_r * x), pixels.out_x);
      store(keep(edge & counts, per_r * y), pixels.out_y);
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
        const Lanes outside = keep(edge, light[c]);
        store(outside, pixels.outside[c]);
        rest[c] -= (one - cover) * outside;
      }
    }
    const Lanes counted = keep(counts, cover), shrunk = smaller(one, all_lanes(kOutermost) * per_r);
    const Lanes nx = shrunk * x, ny = shrunk * y;
    store(counted, pixels.cover);
    store(counted * nx, pixels.slopes[0]);
    store(counted * ny, pixels.slopes[1]);
    store(counted * root(larger(one - nx * nx - ny * ny, zero)), pixels.slopes[2]);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) store(rest[c], pixels.rest[c]);
    return true;
  });
}

/// Eight pixels of the disk against what the shades predict.
struct ShadedPixels {
  std::array<Lanes, kShadeTerms> terms;  // w and w n
  LightLanes model, error;               // error: what is seen less the model
  LightLanes rest;
  Lanes weight;

  ShadedPixels(const DiskPixels& pixels, const BallShades& shades)
      : terms{load(pixels.cover), load(pixels.slopes[0]), load(pixels.slopes[1]), load(pixels.slopes[2])} {
    Lanes square = all_lanes(0.0f);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      const std::array<float, kShadeTerms>& of = shades.of[c];
      model[c] = (all_lanes(of[0]) * terms[0] + all_lanes(of[1]) * terms[1]) +
                 (all_lanes(of[2]) * terms[2] + all_lanes(of[3]) * terms[3]);
      // A channel that is cut off shows that light, or more.
      rest[c] = larger(load(pixels.rest[c]), smaller(model[c], load(pixels.up_to[c])));
      error[c] = rest[c] - model[c];
      square += error[c] * error[c];
    }
    weight = all_lanes(shades.allowed) / (all_lanes(shades.allowed) + square);
  }
};

inline ShadeSums fit_shades(const Disk& disk, const BallShades& before) {
  const Lanes zero = all_lanes(0.0f);
  std::array<std::array<Lanes, kShadeTerms>, kShadeTerms> normal;
  std::array<std::array<Lanes, kShadeTerms>, kLightChannels> right;
  for (auto& row : normal) row.fill(zero);
  for (auto& row : right) row.fill(zero);
  for (const DiskPixels& stored : disk) {
    const ShadedPixels pixels(stored, before);
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
      const Lanes term = pixels.weight * pixels.terms[i];
      TOUCHLINE_UNROLL for (std::size_t j = 0; j <= i; ++j) normal[i][j] += term * pixels.terms[j];
      TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) right[c][i] += term * pixels.rest[c];
    }
  }
  ShadeSums sums;
  TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
    TOUCHLINE_UNROLL for (std::size_t j = 0; j <= i; ++j) sums.normal[i][j] = sum_of(normal[i][j]);
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) sums.right[c][i] = sum_of(right[c][i]);
  }
  return sums;
}

inline OutlineSums fit_outline(const Disk& disk, const BallShades& shades, float radius_px) {
  const Lanes zero = all_lanes(0.0f), steepness = all_lanes(radius_px / kRampPx);
  Lanes xx = zero, xy = zero, yy = zero, rx = zero, ry = zero, fitting = zero, covered = zero;
  std::array<std::array<Lanes, kShadeTerms>, kLightChannels> shared_x, shared_y;
  for (auto& row : shared_x) row.fill(zero);
  for (auto& row : shared_y) row.fill(zero);
  for (const DiskPixels& stored : disk) {
    const ShadedPixels pixels(stored, shades);
    const Lanes cover = pixels.terms[0];
    fitting += pixels.weight * cover;
    covered += cover;
    if (!stored.on_edge) continue;
    const Lanes whole = all_lanes(1.0f) / larger(cover, all_lanes(1e-6f));
    const Lanes out_x = load(stored.out_x), out_y = load(stored.out_y);
    const Lanes weight_x = pixels.weight * out_x, weight_y = pixels.weight * out_y;
    Lanes power = zero, along = zero;
    TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
      const Lanes change = (pixels.model[c] * whole - load(stored.outside[c])) * steepness;
      power += change * change;
      along += change * pixels.error[c];
      const Lanes by_x = weight_x * change, by_y = weight_y * change;
      TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
        shared_x[c][i] += by_x * pixels.terms[i];
        shared_y[c][i] += by_y * pixels.terms[i];
      }
    }
    xx += weight_x * power * out_x;
    xy += weight_x * power * out_y;
    yy += weight_y * power * out_y;
    rx += weight_x * along;
    ry += weight_y * along;
  }
  OutlineSums sums;
  sums.edge = {sum_of(xx), sum_of(xy), sum_of(yy), sum_of(rx), sum_of(ry), 0.0f, 0.0f};
  TOUCHLINE_UNROLL for (std::size_t c = 0; c < kLightChannels; ++c) {
    TOUCHLINE_UNROLL for (std::size_t i = 0; i < kShadeTerms; ++i) {
      sums.shared_x[c][i] = sum_of(shared_x[c][i]);
      sums.shared_y[c][i] = sum_of(shared_y[c][i]);
    }
  }
  sums.fitting = sum_of(fitting);
  sums.covered = sum_of(covered);
  return sums;
}

}  // namespace TOUCHLINE_LANES
}  // namespace touchline
