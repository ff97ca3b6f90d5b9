#include "core/marker/surface_color.h"

#include <algorithm>
#include <cmath>

#include "core/light/shading.h"
#include "core/marker/pixel_rows.h"
#include "core/marker/simd4.h"

namespace touchline {
namespace {

// Share of the range of nine samples that counts as error of their mean. (Nine values with the standard deviation 1
// have a range of 3, and their mean has an error of 1/3.)
constexpr float kRangeError = 0.25f;
// Number of samples on each side of the seed; it covers every pixel of the longest patches at 200 pixels per meter.
constexpr int kGridReach = 23;
constexpr std::size_t kGridSize = 2 * kGridReach + 1;
// Largest distance from the seed's color, relative to the color's length: noise and uneven light within a patch stay
// below a tenth, and differences to other patches of real robots begin at a quarter.
constexpr float kSameColor = 0.2f;
constexpr int kMinSamples = 9;

using Grid = std::array<std::uint64_t, kGridSize>;  // one bit per sample

// Samples along one axis: seed + i * step for i from `first` to `last`, all in the picture.
struct Samples {
  int seed, first, last;
  [[nodiscard]] int place(int i, int step) const { return seed + i * step; }
};
// Returns the index of sample i in a grid.
constexpr int in_grid(int i) { return i + kGridReach; }

// Finds the samples whose squared color distance from the surface is at most the limit. The middle sample always
// counts, although it may be noise. Rows are read outwards until a row has no sample next to one of the previous row,
// because no sample beyond can be connected with the middle.
Grid similar_samples(const Frame& frame, const Samples& columns, const Samples& rows, int step,
                     const SurfaceColor& surface, float allowed) {
  constexpr std::size_t kTogether = 4;
  const auto first_column = static_cast<std::size_t>(in_grid(columns.first)),
             end_column = static_cast<std::size_t>(in_grid(columns.last)) + 1;
  // Samples beyond the last column repeat the last one.
  PixelRows<kGridSize + kTogether> pixels(frame);
  for (std::size_t i = first_column; i < end_column + kTogether; ++i) {
    const int column = static_cast<int>(std::min(i, end_column - 1)) - kGridReach;
    pixels.set_column(i, static_cast<std::size_t>(columns.place(column, step)));
  }
  const std::uint64_t inside = (std::uint64_t{1} << end_column) - (std::uint64_t{1} << first_column);
  const auto similar_in = [&](int row) {
    pixels.select(static_cast<std::size_t>(rows.place(row, step)));
    std::uint64_t similar = 0;
    for (std::size_t i = first_column; i < end_column; i += kTogether) {
      const std::array<Simd4<float>, 3> rgb = pixels.read<1>(i);
      Simd4<float> distance{};
      // gcc 12 unrolls no loops at -O2.
      _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
        const Simd4<float> difference = rgb[c] - surface.rgb[c];
        distance += difference * difference;
      }
      similar |= std::uint64_t{bits_of(distance <= allowed)} << i;
    }
    return similar & inside;
  };
  Grid mask{};
  mask[kGridReach] = similar_in(0) | std::uint64_t{1} << static_cast<unsigned>(kGridReach);
  for (const int way : {1, -1}) {
    const int last = way > 0 ? rows.last : rows.first;
    for (int row = way; way * row <= way * last; row += way) {
      std::uint64_t& similar = mask[static_cast<std::size_t>(in_grid(row))];
      similar = similar_in(row);
      if ((similar & mask[static_cast<std::size_t>(in_grid(row - way))]) == 0) break;
    }
  }
  return mask;
}

// Returns the samples of a row that are connected with `seeds` within it (Kogge and Stone's parallel prefix).
std::uint64_t filled(std::uint64_t seeds, std::uint64_t mask) {
  std::uint64_t right = mask, left = mask;
  std::uint64_t out = seeds & mask;
  for (unsigned by = 1; by < kGridSize; by *= 2) {
    out |= right & out << by;
    right &= right << by;
    out |= left & out >> by;
    left &= left >> by;
  }
  return out;
}

// Keeps only the samples that are connected with the one in the middle. `mask` is empty beyond `reach` rows from it.
Grid connected(const Grid& mask, int reach) {
  Grid out{};
  out[kGridReach] = filled(std::uint64_t{1} << static_cast<unsigned>(kGridReach), mask[kGridReach]);
  int first = kGridReach, last = kGridReach;  // rows that are reached
  // Rows are passed downwards and upwards in turn. (A spiral would need more passes, but no patch is a spiral.)
  for (std::size_t pass = 0; pass < kGridSize; ++pass) {
    bool changed = false;
    const auto reach_row = [&](int row, int from) {
      std::uint64_t& here = out[static_cast<std::size_t>(row)];
      const std::uint64_t similar = mask[static_cast<std::size_t>(row)];
      if ((out[static_cast<std::size_t>(from)] & similar & ~here) == 0) return;
      here = filled(here | out[static_cast<std::size_t>(from)], similar);
      changed = true;
    };
    for (int row = first + 1; row <= kGridReach + reach; ++row) {
      reach_row(row, row - 1);
      if (out[static_cast<std::size_t>(row)] == 0) break;
      last = std::max(last, row);
    }
    for (int row = last - 1; row >= kGridReach - reach; --row) {
      reach_row(row, row + 1);
      if (out[static_cast<std::size_t>(row)] == 0) break;
      first = std::min(first, row);
    }
    if (!changed) break;
  }
  return out;
}

// Mean of z^4 of a square with sides parallel to the axes, relative to the squared mean of |z|^2.
constexpr float kSquareMoment = -0.6f;

// Finds the direction of a square's sides from the mean of z^4, where z is a sample's position relative to the centroid
// as a complex number. `spread`: mean of |z|^2.
void find_sides(const Grid& grown, float count, const std::array<float, 2>& centroid, float spread, GrownPatch& out) {
  using Four = Simd4<float>;
  Four real{}, imaginary{};
  for (std::size_t row = 0; row < kGridSize; ++row) {
    const Four away = Four{} + (static_cast<float>(row) - static_cast<float>(kGridReach) - centroid[1]);
    for_each_four(grown[row], [&](Four column, Simd4<std::int32_t> is_grown) {
      const Four x = is_grown ? column - (static_cast<float>(kGridReach) + centroid[0]) : Four{};
      const Four y = is_grown ? away : Four{};
      const Four difference = x * x - y * y, product = 2.0f * x * y;
      real += difference * difference - product * product;
      imaginary += 2.0f * difference * product;
    });
  }
  const float re = sum_of_lanes(real), im = sum_of_lanes(imaginary);
  out.side_rad = 0.25f * std::atan2(-im, -re);
  out.squareness = std::hypot(re, im) / (count * -kSquareMoment * spread * spread);
}

}  // namespace

bool sample_surface(const Frame& frame, PixelPoint center, int step_px, SurfaceColor& out, int saturated_from) {
  // This rejects NaN, too.
  if (!(center.u_px >= 0.0f && center.v_px >= 0.0f && center.u_px < 65536.0f && center.v_px < 65536.0f)) return false;
  const int u = static_cast<int>(std::lround(center.u_px)), v = static_cast<int>(std::lround(center.v_px));
  if (u < step_px || v < step_px || u + step_px >= frame.width_px || v + step_px >= frame.height_px) return false;
  const PixelFormatInfo& info = info_of(frame.format);
  const std::array<int, 3> away{-step_px, 0, step_px};
  std::array<float, 3> mean;
  int range = 0;
  // gcc 12 unrolls no loops at -O2.
  _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info.channel[c];
    std::array<std::size_t, 3> offsets;
    std::array<const std::uint8_t*, 3> lines;
    _Pragma("GCC unroll 3") for (std::size_t i = 0; i < 3; ++i) {
      const int column = u + away[i], row = v + away[i];
      offsets[i] = channel.byte(static_cast<std::size_t>(column));
      lines[i] = frame.plane[channel.plane] +
                 (static_cast<std::size_t>(row) >> channel.shift_v) * frame.stride_bytes[channel.plane];
    }
    int sum = 0, low = 255, high = 0;
    _Pragma("GCC unroll 9") for (std::size_t i = 0; i < 9; ++i) {
      const int value = lines[i / 3][offsets[i % 3]];
      sum += value;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    mean[c] = static_cast<float>(sum - low - high) / 7.0f;
    range = std::max(range, high - low);
  }
  out.spread.fill(kRangeError * static_cast<float>(range));
  out.rgb = to_rgb(mean, info.space);
  out.saturated_from = saturated_from;
  for (std::size_t c = 0; c < 3; ++c) {
    out.saturated[c] = out.rgb[c] >= static_cast<float>(saturated_from);
  }
  return true;
}

bool grow_patch(const Frame& frame, PixelPoint seed, float reach_px, GrownPatch& out) {
  SurfaceColor surface;
  if (!sample_surface(frame, seed, 1, surface)) return false;
  const int step = std::max(1, static_cast<int>(std::ceil(reach_px / static_cast<float>(kGridReach))));
  const int reach = std::min(kGridReach, static_cast<int>(reach_px) / step);
  const int seed_u = static_cast<int>(std::lround(seed.u_px)), seed_v = static_cast<int>(std::lround(seed.v_px));
  float length = 0;
  for (const float value : surface.rgb) length += value * value;
  const float allowed = kSameColor * kSameColor * length;
  // Range of the samples that are in the picture.
  const auto first = [&](int at) { return std::max(-reach, -(at / step)); };
  const auto last = [&](int at, int size) { return std::min(reach, (size - 1 - at) / step); };
  const int left = first(seed_u), right = last(seed_u, frame.width_px);
  const int top = first(seed_v), bottom = last(seed_v, frame.height_px);
  const int inside = (right - left + 1) * (bottom - top + 1), all = (2 * reach + 1) * (2 * reach + 1);
  if (5 * (all - inside) > all) return false;
  const Grid mask = similar_samples(frame, {seed_u, left, right}, {seed_v, top, bottom}, step, surface, allowed);
  const Grid grown = connected(mask, reach);
  // The sums are integers below 2^24, so their order does not matter.
  Simd4<float> ones{}, sum_x{}, sum_y{}, sum_xx{}, sum_xy{}, sum_yy{};
  for (std::size_t row = 0; row < kGridSize; ++row) {
    const float away = static_cast<float>(row) - static_cast<float>(kGridReach);
    for_each_four(grown[row], [&](Simd4<float> column, Simd4<std::int32_t> is_grown) {
      const Simd4<float> one = is_grown ? Simd4<float>{1, 1, 1, 1} : Simd4<float>{};
      const Simd4<float> dx = one * (column - static_cast<float>(kGridReach)), dy = one * away;
      ones += one;
      sum_x += dx;
      sum_y += dy;
      sum_xx += dx * dx;
      sum_xy += dx * dy;
      sum_yy += dy * dy;
    });
  }
  const float n = sum_of_lanes(ones);
  float x = sum_of_lanes(sum_x), y = sum_of_lanes(sum_y), xx = sum_of_lanes(sum_xx), xy = sum_of_lanes(sum_xy),
        yy = sum_of_lanes(sum_yy);
  if (n < static_cast<float>(kMinSamples)) return false;
  const float scale = static_cast<float>(step), square = scale * scale;
  x /= n;
  y /= n;
  xx = xx / n - x * x;
  xy = xy / n - x * y;
  yy = yy / n - y * y;
  const float middle = 0.5f * (xx + yy), half = std::hypot(0.5f * (xx - yy), xy);
  out.center = {static_cast<float>(seed_u) + scale * x, static_cast<float>(seed_v) + scale * y};
  out.area_px = square * n;
  // The 1/12 is added because pixels are squares, not points.
  out.major_px2 = square * (middle + half + 1.0f / 12.0f);
  out.minor_px2 = square * (std::max(0.0f, middle - half) + 1.0f / 12.0f);
  out.axis_rad = 0.5f * std::atan2(2.0f * xy, xx - yy);
  find_sides(grown, n, {x, y}, xx + yy, out);
  return true;
}

}  // namespace touchline
