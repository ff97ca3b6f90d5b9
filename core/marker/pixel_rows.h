#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/marker/simd4.h"
#include "core/types.h"

namespace touchline {

// PixelRows assumes that in RGB, all channels of a pixel are within four bytes of one plane, and within three in 24-bit
// formats.
static_assert(std::endian::native == std::endian::little);
static_assert(std::all_of(kPixelFormatTable.begin(), kPixelFormatTable.end(), [](const PixelFormatInfo& info) {
  return info.space != ColorSpace::kRgb ||
         std::all_of(info.channel.begin(), info.channel.end(), [](const ChannelLayout& channel) {
           return channel.plane == 0 && channel.shift_u == 0 && channel.shift_v == 0 && channel.offset < 3 &&
                  (channel.step == 3 || channel.step == 4);
         });
}));

/// Reads columns of a picture, row after row, four at a time, as R, G, B above black. The frame must outlive it.
template <std::size_t kColumns>
class PixelRows {
 public:
  explicit PixelRows(const Frame& frame)
      : frame_(frame),
        info_(info_of(frame.format)),
        has_words_(info_.space == ColorSpace::kRgb && frame.height_px > 1),
        step_(info_.channel[0].step) {}

  /// Assigns pixel column u to column `i`.
  void set_column(std::size_t i, std::size_t u) {
    if (has_words_) {
      offset_[0][i] = static_cast<std::uint32_t>(u * step_);
      return;
    }
    for (std::size_t c = 0; c < 3; ++c) offset_[c][i] = static_cast<std::uint32_t>(info_.channel[c].byte(u));
  }

  /// Selects pixel row v for reading.
  void select(std::size_t v) {
    if (has_words_) {
      // Four bytes are read for each pixel. For the picture's last pixel, they may have to begin one byte earlier.
      const bool from_before = step_ == 3 && v + 1 == static_cast<std::size_t>(frame_.height_px);
      row_[0] = frame_.plane[0] + v * frame_.stride_bytes[0] - (from_before ? 1 : 0);
      for (std::size_t c = 0; c < 3; ++c) shift_[c] = 8 * (info_.channel[c].offset + (from_before ? 1 : 0));
      return;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelLayout& channel = info_.channel[c];
      row_[c] = frame_.plane[channel.plane] + (v >> channel.shift_v) * frame_.stride_bytes[channel.plane];
    }
  }

  /// Reads columns `first`, `first + kEvery` and two more.
  template <std::size_t kEvery>
  [[nodiscard, gnu::always_inline]] std::array<Simd4<float>, 3> read(std::size_t first) const {
    if (!has_words_) return read_samples<kEvery>(first);
    const std::uint32_t* const at = &offset_[0][first];
    const Simd4<std::int32_t> four{word(at[0]), word(at[kEvery]), word(at[2 * kEvery]), word(at[3 * kEvery])};
    const auto channel = [&](std::size_t c) {
      return __builtin_convertvector((four >> shift_[c]) & 255, Simd4<float>);
    };
    return {channel(0), channel(1), channel(2)};
  }

 private:
  template <std::size_t kEvery>
  [[nodiscard, gnu::noinline]] std::array<Simd4<float>, 3> read_samples(std::size_t first) const {
    std::array<Simd4<float>, 3> out;
    // gcc 12 unrolls no loops at -O2.
    _Pragma("GCC unroll 3") for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t* const pixels = row_[c];
      const std::uint32_t* const at = &offset_[c][first];
      const Simd4<std::int32_t> four{pixels[at[0]], pixels[at[kEvery]], pixels[at[2 * kEvery]], pixels[at[3 * kEvery]]};
      out[c] = __builtin_convertvector(four, Simd4<float>);
    }
    return info_.space == ColorSpace::kRgb ? out : yuv_to_rgb4(out, info_.space);
  }

  [[nodiscard, gnu::always_inline]] std::int32_t word(std::uint32_t offset) const {
    std::int32_t bytes = 0;
    std::memcpy(&bytes, row_[0] + offset, sizeof bytes);
    return bytes;
  }

  const Frame& frame_;
  const PixelFormatInfo& info_;
  // The channels of a pixel are read together, as four bytes. If the picture has a single row, its last pixel may have
  // no fourth byte, and no byte before it.
  bool has_words_;
  std::size_t step_;
  std::array<int, 3> shift_{};
  std::array<const std::uint8_t*, 3> row_{};
  // Byte offset per column and channel; word reads use only [0].
  std::array<std::array<std::uint32_t, kColumns>, 3> offset_;
};

}  // namespace touchline
