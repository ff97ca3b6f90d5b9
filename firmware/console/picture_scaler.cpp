#include "firmware/console/picture_scaler.h"

#include <algorithm>
#include <array>

namespace touchline::console {
namespace {

// Maps limited range to full range, which JPEG uses (JFIF 1.02).
std::array<std::uint8_t, 256> to_full_range(std::size_t channel) {
  std::array<std::uint8_t, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float value = static_cast<float>(i);
    const float full = channel == 0 ? (value - 16.0f) * 255.0f / 219.0f : (value - 128.0f) * 255.0f / 224.0f + 128.0f;
    table[i] = static_cast<std::uint8_t>(std::clamp(full + 0.5f, 0.0f, 255.0f));
  }
  return table;
}

void expand_range(ColorSpace space, std::size_t channel, std::span<std::uint8_t> row) {
  static const std::array<std::uint8_t, 256> luma = to_full_range(0), chroma = to_full_range(1);
  if (space != ColorSpace::kYuv) return;
  const std::array<std::uint8_t, 256>& table = channel == 0 ? luma : chroma;
  for (std::uint8_t& value : row) value = table[value];
}

void repeat_last(std::span<std::uint8_t> row, std::size_t used) {
  std::fill(row.begin() + static_cast<std::ptrdiff_t>(used), row.end(), row[used - 1]);
}

}  // namespace

// Computes means of side x side pixels; each sample is read once, even if several pixels share it.
void PictureScaler::mean_row(std::size_t channel, std::size_t v, std::size_t side, std::size_t count, std::uint8_t* out,
                             std::size_t step) const {
  const ChannelLayout& layout = info_of(frame_.format).channel[channel];
  const std::size_t samples = std::max<std::size_t>(side >> layout.shift_u, 1);
  const std::size_t rows = std::max<std::size_t>(side >> layout.shift_v, 1);
  const std::size_t first_row = (v * side) >> layout.shift_v;
  const std::size_t last_row = plane_rows(frame_.format, layout.plane, frame_.height_px) - 1;
  const std::size_t in_row = (std::size_t{frame_.width_px} + (std::size_t{1} << layout.shift_u) - 1) >> layout.shift_u;
  const std::uint8_t* const plane = frame_.plane[layout.plane] + layout.offset;
  const std::size_t stride = frame_.stride_bytes[layout.plane];
  const std::uint32_t area = static_cast<std::uint32_t>(samples * rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = (i * side) >> layout.shift_u;
    std::uint32_t sum = area / 2;
    for (std::size_t y = 0; y < rows; ++y) {
      const std::uint8_t* const row = plane + std::min(first_row + y, last_row) * stride;
      for (std::size_t x = 0; x < samples; ++x) sum += row[std::min(first + x, in_row - 1) * layout.step];
    }
    out[i * step] = static_cast<std::uint8_t>(sum / area);
  }
}

void PictureScaler::rgb_row(std::size_t v, std::span<std::uint8_t> out) const {
  for (std::size_t c = 0; c < 3; ++c) {
    mean_row(c, v, static_cast<std::size_t>(divisor_), width_px(), out.data() + c, 3);
  }
}

void PictureScaler::luma_row(std::size_t v, std::span<std::uint8_t> out) const {
  const std::size_t width = width_px();
  mean_row(0, v, static_cast<std::size_t>(divisor_), width, out.data(), 1);
  expand_range(color_space(frame_.format), 0, out.first(width));
  repeat_last(out, width);
}

void PictureScaler::chroma_row(std::size_t v, std::size_t channel, std::span<std::uint8_t> out) const {
  const std::size_t width = (std::size_t{width_px()} + 1) / 2;
  mean_row(channel, v, 2 * static_cast<std::size_t>(divisor_), width, out.data(), 1);
  expand_range(color_space(frame_.format), channel, out.first(width));
  repeat_last(out, width);
}

}  // namespace touchline::console
