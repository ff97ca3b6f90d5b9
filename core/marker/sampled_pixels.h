#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/marker/ball_appearance.h"
#include "core/marker/ball_color.h"
#include "core/marker/ball_samples.h"
#include "core/marker/pixel_rows.h"

// The pixels around a possible ball, on a square grid of samples.
namespace touchline {

// Mask of every second column; this is enough, because the surroundings are wide. A row has two such groups.
constexpr std::uint64_t kCoarseColumns = 0x55555555u;
static_assert(kSampleReach == 2 * kGroupSize);
/// Reads a row of the grid of samples. Samples outside the picture repeat the pixels at its edge. The frame must
/// outlive it.
class SampledPixels {
 public:
  SampledPixels(const Frame& frame, int seed_u, int seed_v, int step)
      : rows_(frame), seed_u_(seed_u), seed_v_(seed_v), step_(step) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      const int u = seed_u + (static_cast<int>(i) - kSampleReach) * step;
      if (i < kSampleSide && u >= 0 && u < frame.width_px) columns_ |= std::uint64_t{1} << i;
      rows_.set_column(i, static_cast<std::size_t>(std::clamp(u, 0, frame.width_px - 1)));
    }
  }
  // Returns the columns that are in the picture.
  [[nodiscard]] std::uint64_t columns() const { return columns_; }
  // Convert columns and rows of the grid to pixels, and pixels back to columns and rows.
  [[nodiscard]] int u_px(int column) const { return seed_u_ + column * step_; }
  [[nodiscard]] int v_px(int row) const { return seed_v_ + row * step_; }
  [[nodiscard]] float column_at(float u_px) const {
    return (u_px - static_cast<float>(seed_u_)) / static_cast<float>(step_);
  }

  // Selects a row, which must be in the picture.
  void select(int row) { rows_.select(static_cast<std::size_t>(v_px(row))); }
  // Reads every `kEvery`-th column from `first` on.
  template <std::size_t kEvery>
  void read(int first, PixelGroup& out) const {
    // gcc 12 unrolls no loops at -O2.
    _Pragma("GCC unroll 2") for (std::size_t half = 0; half < 2; ++half) {
      const auto four = rows_.template read<kEvery>(sample_index(first) + 4 * half * kEvery);
      _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) out[c][half] = four[c];
    }
  }

 private:
  // A group of consecutive columns may begin at any column of the square, and then ends beyond it; a group of every
  // second column ends at the last column of the square at the latest.
  static constexpr std::size_t kColumns = kSampleSide + kGroupSize - 1;

  PixelRows<kColumns> rows_;
  int seed_u_, seed_v_, step_;
  std::uint64_t columns_ = 0;
};

/// Outline of a robot's top in the picture, a parallelogram.
class TopOutline {
 public:
  TopOutline() = default;
  explicit TopOutline(const RobotTop& top) : center_(top.center) {
    const PixelPoint &x = top.half_side[0], &y = top.half_side[1];
    reach_v_px_ = std::abs(x.v_px) + std::abs(y.v_px);
    const float determinant = x.u_px * y.v_px - y.u_px * x.v_px;
    if (std::abs(determinant) < 1e-6f) {
      reach_v_px_ = -1.0f;
      return;
    }
    inverse_ = {{{y.v_px / determinant, -y.u_px / determinant}, {-x.v_px / determinant, x.u_px / determinant}}};
  }
  // Returns the columns whose samples are on the top.
  [[nodiscard]] std::uint64_t covers(const SampledPixels& pixels, int row) const {
    const float dv = static_cast<float>(pixels.v_px(row)) - center_.v_px;
    if (std::abs(dv) > reach_v_px_) return 0;
    // In this row, the top reaches from u = middle - distance to middle + distance, where its own coordinate along one
    // axis is -1 and 1. Both axes limit it.
    float first = -1e6f, last = 1e6f;
    for (const auto& [per_u, per_v] : inverse_) {
      if (std::abs(per_u) < 1e-6f) {
        if (std::abs(per_v * dv) >= 1.0f) return 0;
        continue;
      }
      const float middle = center_.u_px - per_v / per_u * dv, distance = 1.0f / std::abs(per_u);
      first = std::max(first, pixels.column_at(middle - distance));
      last = std::min(last, pixels.column_at(middle + distance));
    }
    first = std::max(first, static_cast<float>(-kSampleReach - 1));
    last = std::min(last, static_cast<float>(kSampleReach + 1));
    if (!(last > first)) return 0;
    // Samples exactly on a side are not covered.
    const int from = static_cast<int>(std::floor(first)) + 1, to = static_cast<int>(std::ceil(last)) - 1;
    return from <= to ? 2 * sample_bit(to) - sample_bit(from) : 0;
  }

 private:
  PixelPoint center_;
  float reach_v_px_ = 0;
  // Matrix from pixels to coordinates in half sides.
  std::array<std::array<float, 2>, 2> inverse_{};
};

/// Classes of the samples around a seed.
class BallSamples {
 public:
  // `reach`: reach of the surroundings; `dense`: radius within which all samples count.
  BallSamples(const Frame& frame, SampledPixels& pixels, std::span<const TopOutline> tops, int reach, int dense)
      : pixels_(pixels), reach_(reach), dense_(0.0f, static_cast<float>(dense) + 0.01f) {
    for (int row = -reach; row <= reach; ++row) {
      if (pixels.v_px(row) < 0 || pixels.v_px(row) >= frame.height_px) continue;
      std::uint64_t columns = std::abs(row) <= dense ? middle_sample_bits(dense_.last[distance(row)]) : 0;
      if (row % 2 == 0) columns |= kCoarseColumns & middle_sample_bits(reach);
      columns &= pixels.columns();
      for (const TopOutline& top : tops) columns &= ~top.covers(pixels, row);
      visible.row(row) = columns;
    }
  }

  // Reads every second row and column. Returns how many have the ball's color.
  int read_coarse(const BallColor& color) {
    PixelGroup group;
    int count = 0;
    for (int row = -(reach_ - reach_ % 2); row <= reach_; row += 2) {
      const std::uint64_t columns = visible.row(row) & kCoarseColumns;
      if (columns == 0) continue;
      pixels_.select(row);
      std::uint64_t is_ball = 0, is_colorful = 0;
      for (const int first : {-kSampleReach, 0}) {
        pixels_.read<2>(first, group);
        is_ball |= spread(color.is_ball(group)) << sample_index(first);
        is_colorful |= spread(color.is_colorful(group)) << sample_index(first);
      }
      coarse.row(row) = columns;
      ball.row(row) = is_ball & columns;
      colorful.row(row) = is_colorful & ~is_ball & columns;
      count += count_sample_bits(is_ball & columns);
    }
    return count;
  }

  // Reads the samples between known ones of the ball's color, and their neighbors; reads all samples if `all` is set.
  void read_dense(const BallColor& color, bool all) {
    std::uint64_t any = 0;
    int top = kSampleReach, bottom = -kSampleReach;
    for (int row = -reach_; row <= reach_; ++row) {
      any |= ball.row(row);
      if (ball.row(row) == 0) continue;
      top = std::min(top, row);
      bottom = row;
    }
    if (any == 0 && !all) return;
    const int left = all ? -kSampleReach : std::countr_zero(any) - kSampleReach - 1;
    const int right = all ? kSampleReach : static_cast<int>(std::bit_width(any)) - kSampleReach;
    const int first_row = std::max(all ? -kSampleReach : top - 1, -dense_.reach);
    const int last_row = std::min(all ? kSampleReach : bottom + 1, dense_.reach);
    PixelGroup group;
    for (int row = first_row; row <= last_row; ++row) {
      if (visible.row(row) == 0) continue;
      const int last = dense_.last[distance(row)];
      pixels_.select(row);
      std::uint64_t is_ball = 0;
      for (int first = std::max(-last, left); first <= std::min(last, right); first += kGroupSize) {
        pixels_.read<1>(first, group);
        is_ball |= std::uint64_t{color.is_ball(group)} << sample_index(first);
      }
      ball.row(row) |= is_ball & visible.row(row);
    }
  }

  Samples visible, ball;
  Samples coarse, colorful;  // samples of every second row and column

 private:
  static std::size_t distance(int row) { return static_cast<std::size_t>(std::abs(row)); }
  // Moves bit i to bit 2 i.
  static std::uint64_t spread(std::uint32_t byte) {
    byte = (byte | byte << 4u) & 0x0f0fu;
    byte = (byte | byte << 2u) & 0x3333u;
    return (byte | byte << 1u) & 0x5555u;
  }

  SampledPixels& pixels_;
  int reach_;
  SampleRing dense_;
};

}  // namespace touchline
