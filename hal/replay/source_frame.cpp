#include "hal/replay/source_frame.h"

#include <algorithm>
#include <array>

#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

constexpr std::size_t kRowAlignmentBytes = 4;

std::uint8_t rounded_to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f)); }

/// The pixels that share a sample: `width` x `height` from column `u` and row `v` on.
struct Block {
  std::size_t u, v, width, height;
};

std::array<float, 3> mean_of(const Picture& picture, const Block& block) {
  std::array<std::uint32_t, 3> sum{};
  for (std::size_t v = block.v; v < block.v + block.height; ++v) {
    const std::size_t begin = 3 * (v * picture.width_px + block.u);
    for (std::size_t i = 0; i < 3 * block.width; ++i) sum[i % 3] += picture.rgb8[begin + i];
  }
  const auto count = static_cast<float>(block.width * block.height);
  return {static_cast<float>(sum[0]) / count, static_cast<float>(sum[1]) / count, static_cast<float>(sum[2]) / count};
}

Picture rounded_to_8_bits(const Picture& picture) {
  Picture out{picture.width_px, picture.height_px, {}, {}};
  out.rgb8.resize(picture.rgb16.size());
  std::transform(picture.rgb16.begin(), picture.rgb16.end(), out.rgb8.begin(),
                 [](std::uint32_t value) { return static_cast<std::uint8_t>((value * 255 + 65535 / 2) / 65535); });
  return out;
}

}  // namespace

Result<void> SourceFrame::resize(PixelFormat format, std::uint32_t width_px, std::uint32_t height_px) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxFrameWidth || height_px > kMaxFrameHeight) {
    return failure(ErrorCode::kUnsupported, "is %u x %u, larger than %u x %u", width_px, height_px,
                   unsigned{kMaxFrameWidth}, unsigned{kMaxFrameHeight});
  }
  view.format = format;
  view.width_px = static_cast<std::uint16_t>(width_px);
  view.height_px = static_cast<std::uint16_t>(height_px);
  const PictureLayout layout = picture_layout(format, width_px, height_px, kRowAlignmentBytes);
  bytes.resize(layout.bytes);
  view.plane = {};
  view.stride_bytes = layout.stride_bytes;
  for (std::size_t i = 0; i < info_of(format).planes; ++i) view.plane[i] = bytes.data() + layout.offset_bytes[i];
  return {};
}

Result<void> convert(const StoredPicture& stored, PixelFormat format, SourceFrame& out) {
  const Picture rounded = stored.values.is_16_bit() ? rounded_to_8_bits(stored.values) : Picture();
  const Picture& picture = stored.values.is_16_bit() ? rounded : stored.values;
  TOUCHLINE_TRY(out.resize(format, picture.width_px, picture.height_px));
  const std::size_t width = picture.width_px, height = picture.height_px;
  const bool keeps_values = stored.is_yuv || !is_yuv(color_space(format));
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelLayout& channel = info_of(format).channel[c];
    const std::size_t columns = std::size_t{1} << channel.shift_u, rows = std::size_t{1} << channel.shift_v;
    // In packed formats the last pair of an odd width repeats the luma of its only pixel.
    const std::size_t samples =
        c == 0 && shares_chroma(format) ? row_bytes(format, 0, width) / channel.step : (width + columns - 1) / columns;
    for (std::size_t v = 0; v < height; v += rows) {
      out.write_row(c, v, samples, [&](std::size_t i) {
        const std::size_t u = std::min(i * columns, width - 1);
        const Block block{u, v, std::min(columns, width - u), std::min(rows, height - v)};
        if (keeps_values && columns * rows == 1) return picture.rgb8[3 * (v * width + u) + c];
        const std::array<float, 3> mean = mean_of(picture, block);
        return rounded_to_byte(keeps_values ? mean[c] : from_rgb(mean, color_space(format))[c]);
      });
    }
  }
  return {};
}

}  // namespace touchline::hal
