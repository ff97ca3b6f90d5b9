#include "tests/benchmark/ssl_vision_scan.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/cpu.h"
#include "tests/color/owned_picture.h"
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace touchline::testing {
namespace {

constexpr std::size_t index_in_table(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return static_cast<std::size_t>(r >> 3 << 11 | g >> 2 << 5 | b >> 3);
}

void look_up(const std::uint8_t* rgb, std::size_t count, const ColorId* table, const std::uint8_t* mask, ColorId* out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = mask[i] & table[index_in_table(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2])];
  }
}

#if defined(__x86_64__)
// For each channel and each of the three vectors of 16 interleaved pixels: positions of the channel's bytes, or -1.
using Places = std::array<std::int8_t, 16>;
alignas(16) constexpr auto kPlaces = [] {
  std::array<std::array<Places, 3>, 3> places{};
  for (int channel = 0; channel < 3; ++channel) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 16; ++i) {
        const int at = 3 * i + channel - 16 * k;
        places[static_cast<std::size_t>(channel)][static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] =
            static_cast<std::int8_t>(at >= 0 && at < 16 ? at : -1);
      }
    }
  }
  return places;
}();

TOUCHLINE_AVX2_INLINE __m128i load_vector(const void* bytes) {
  __m128i vector;
  std::memcpy(&vector, bytes, sizeof vector);
  return vector;
}

TOUCHLINE_AVX2_INLINE __m256i channel_of(const std::uint8_t* rgb, const std::array<Places, 3>& places) {
  const __m128i a = _mm_shuffle_epi8(load_vector(rgb), load_vector(places[0].data()));
  const __m128i b = _mm_shuffle_epi8(load_vector(rgb + 16), load_vector(places[1].data()));
  const __m128i c = _mm_shuffle_epi8(load_vector(rgb + 32), load_vector(places[2].data()));
  return _mm256_cvtepu8_epi16(_mm_or_si128(_mm_or_si128(a, b), c));
}

TOUCHLINE_AVX2 void look_up_avx2(const std::uint8_t* rgb, std::size_t count, const ColorId* table,
                                 const std::uint8_t* mask, ColorId* out) {
  alignas(32) std::array<std::uint16_t, 16> indexes;
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    const std::uint8_t* const bytes = rgb + 3 * i;
    const __m256i r = _mm256_slli_epi16(_mm256_srli_epi16(channel_of(bytes, kPlaces[0]), 3), 11);
    const __m256i g = _mm256_slli_epi16(_mm256_srli_epi16(channel_of(bytes, kPlaces[1]), 2), 5);
    const __m256i b = _mm256_srli_epi16(channel_of(bytes, kPlaces[2]), 3);
    const __m256i index = _mm256_or_si256(r, _mm256_or_si256(g, b));
    std::memcpy(indexes.data(), &index, sizeof index);
#pragma GCC unroll 16
    for (std::size_t k = 0; k < 16; ++k) out[i + k] = mask[i + k] & table[indexes[k]];
  }
  look_up(rgb + 3 * i, count - i, table, mask + i, out + i);
}
#endif

}  // namespace

Status SslVisionScan::configure(const ScanParameters& parameters) {
  if (parameters.format != PixelFormat::kRgb24) return ErrorCode::kUnsupported;
  width_ = parameters.width_px;
  height_ = parameters.height_px;
  table_.resize(std::size_t{1} << 16);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    // Returns the middle of the values with this index.
    const Channels value{static_cast<std::uint8_t>((i >> 11) * 8 + 4), static_cast<std::uint8_t>((i >> 5) % 64 * 4 + 2),
                         static_cast<std::uint8_t>(i % 32 * 8 + 4)};
    table_[i] = color_by_boxes(parameters.boxes, ColorSpace::kRgb, value, {});
  }
  colors_.resize(static_cast<std::size_t>(width_ * height_) + 1);
  mask_.assign(colors_.size(), 255);
  runs_.reserve(colors_.size() + static_cast<std::size_t>(height_));
  found_.reserve(colors_.size());
  return {};
}

const std::vector<SslVisionScan::Found>& SslVisionScan::scan(const Frame& frame) {
  threshold(frame);
  encode_runs();
  connect();
  extract();
  sort_by_area();
  return found_;
}

void SslVisionScan::threshold(const Frame& frame) {
  auto look = look_up;
#if defined(__x86_64__)
  if (cpu_supports(KernelChoice::kAvx2)) look = look_up_avx2;
#endif
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t v = 0; v < static_cast<std::size_t>(height_); ++v) {
    look(frame.plane[0] + v * frame.stride_bytes[0], width, table_.data(), mask_.data() + v * width,
         colors_.data() + v * width);
  }
}

// The last run of a row may be background. A pixel without color after the end of the row ends it.
void SslVisionScan::encode_runs() {
  runs_.clear();
  const int width = width_;
  for (int v = 0; v < height_; ++v) {
    ColorId* const row = colors_.data() + static_cast<std::size_t>(v * width);
    const ColorId behind = row[width];
    row[width] = 255;
    for (int u = 0; u < width;) {
      const ColorId color = row[u];
      const int begin = u;
      while (row[u] == color) ++u;
      if (color == kBackground && u < width) continue;
      runs_.push_back({static_cast<std::int16_t>(v), static_cast<std::int16_t>(begin),
                       static_cast<std::int16_t>(u - begin), color, static_cast<std::int32_t>(runs_.size())});
    }
    row[width] = behind;
  }
}

void SslVisionScan::connect() {
  const auto root = [&](std::int32_t i) {
    while (i != runs_[static_cast<std::size_t>(i)].parent) i = runs_[static_cast<std::size_t>(i)].parent;
    return i;
  };
  std::size_t above = 0, below = 0;
  while (below < runs_.size() && runs_[below].row == 0) ++below;
  while (below < runs_.size()) {
    ColorRun &a = runs_[above], &b = runs_[below];
    if (a.row + 1 < b.row) {
      ++above;
      continue;
    }
    if (a.row == b.row) {
      ++below;
      continue;
    }
    const int end_a = a.begin + a.width, end_b = b.begin + b.width;
    if (a.color == b.color && a.color != kBackground && a.begin < end_b && b.begin < end_a) {
      const std::int32_t i = root(a.parent), j = root(b.parent), least = std::min(i, j);
      runs_[static_cast<std::size_t>(std::max(i, j))].parent = least;
      a.parent = b.parent = least;
    }
    if (end_a <= end_b) ++above;
    if (end_b <= end_a) ++below;
  }
  for (ColorRun& run : runs_) run.parent = runs_[static_cast<std::size_t>(run.parent)].parent;
}

void SslVisionScan::extract() {
  found_.clear();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    ColorRun& run = runs_[i];
    if (run.color == kBackground) continue;
    const float sum_u = 0.5f * static_cast<float>(run.width * (2 * run.begin + run.width - 1));
    const auto sum_v = static_cast<float>(run.row * run.width);
    if (run.parent == static_cast<std::int32_t>(i)) {
      run.parent = static_cast<std::int32_t>(found_.size());
      found_.push_back(
          {run.color, run.width, run.begin, run.row, run.begin + run.width - 1, run.row, sum_u, sum_v, -1});
      continue;
    }
    run.parent = runs_[static_cast<std::size_t>(run.parent)].parent;
    Found& region = found_[static_cast<std::size_t>(run.parent)];
    region.area += run.width;
    region.left = std::min<std::int32_t>(region.left, run.begin);
    region.right = std::max<std::int32_t>(region.right, run.begin + run.width - 1);
    region.bottom = run.row;
    region.u += sum_u;
    region.v += sum_v;
  }
  for (Found& region : found_) {
    region.u /= static_cast<float>(region.area);
    region.v /= static_cast<float>(region.area);
  }
}

// Makes lists by color, each sorted by a radix sort of linked lists, six bits at a time.
void SslVisionScan::sort_by_area() {
  constexpr int kBits = 6;
  first_.fill(-1);
  std::int32_t most = 0;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    most = std::max(most, found_[i].area);
    found_[i].next = first_[found_[i].color];
    first_[found_[i].color] = static_cast<std::int32_t>(i);
  }
  std::array<std::int32_t, 1 << kBits> bins{};
  for (std::int32_t& first : first_) {
    if (first < 0 || found_[static_cast<std::size_t>(first)].next < 0) continue;
    for (int shift = 0; most >> shift != 0; shift += kBits) {
      bins.fill(-1);
      const auto move = [&](std::int32_t from, std::int32_t& to) {
        const std::int32_t rest = found_[static_cast<std::size_t>(from)].next;
        found_[static_cast<std::size_t>(from)].next = to;
        to = from;
        return rest;
      };
      for (std::int32_t i = first; i >= 0;) {
        const auto bin = static_cast<std::size_t>(found_[static_cast<std::size_t>(i)].area >> shift) % bins.size();
        i = move(i, bins[bin]);
      }
      first = -1;
      for (const std::int32_t bin : bins) {
        for (std::int32_t i = bin; i >= 0;) i = move(i, first);
      }
    }
  }
}

}  // namespace touchline::testing
