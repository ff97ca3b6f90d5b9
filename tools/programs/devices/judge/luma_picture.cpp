#include "tools/programs/devices/judge/luma_picture.h"

namespace touchline::devices {

LumaReader::LumaReader(const Frame& frame) {
  const std::size_t channel = color_space(frame.format) == ColorSpace::kRgb ? 1 : 0;
  const ChannelLayout& layout = info_of(frame.format).channel[channel];
  first_ = frame.plane[layout.plane] + layout.offset;
  stride_ = frame.stride_bytes[layout.plane];
  step_ = layout.step;
}

void read_luma(const Frame& frame, std::size_t square, LumaPicture& out) {
  const LumaReader luma(frame);
  out.width = frame.width_px / square;
  out.height = frame.height_px / square;
  out.value.assign(out.width * out.height, 0.0f);
  for (std::size_t v = 0; v < out.height * square; ++v) {
    float* const row = &out.value[v / square * out.width];
    for (std::size_t u = 0; u < out.width * square; ++u) row[u / square] += luma(u, v);
  }
  const float factor = 1.0f / static_cast<float>(square * square);
  for (float& value : out.value) value *= factor;
}

}  // namespace touchline::devices
