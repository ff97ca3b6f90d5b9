#include "tools/programs/latency/stress_pattern_camera.h"

#include <algorithm>
#include <optional>

namespace touchline::latency {
namespace {

constexpr std::size_t kPatchPx = 12;  // size of a patch of 37.5 mm if 640 pixels cover 2.2 m

std::uint32_t next_random(std::uint32_t& state) {
  state = state * 1664525u + 1013904223u;  // linear congruential generator of Numerical Recipes
  return state >> 16;
}

// Returns a hash of the position.
std::uint32_t position_hash(std::size_t u, std::size_t v) {
  auto hash = static_cast<std::uint32_t>(u * 0x9E3779B1u ^ v * 0x85EBCA77u);
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  return (hash ^ hash >> 12) >> 4;
}

bool in_box(const ColorBox& box, const std::array<std::uint8_t, 3>& value) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (value[i] < box.low[i] || value[i] > box.high[i]) return false;
  }
  return true;
}

}  // namespace

StressPatternCamera::StressPatternCamera(const PipelineParameters& parameters, const hal::Clock& clock)
    : parameters_(parameters), clock_(clock) {}

void StressPatternCamera::choose_values() {
  const ColorBoxes& boxes = parameters_.scan.boxes;
  values_.assign(1, {0, 128, 128});
  const auto in_any = [&boxes](const Value& value) {
    return std::any_of(boxes.begin(), boxes.end(), [&value](const ColorBox& box) { return in_box(box, value); });
  };
  std::uint32_t random = 1;
  for (int tries = 0; tries < 10000 && in_any(values_[0]); ++tries) {
    for (std::uint8_t& channel : values_[0]) channel = static_cast<std::uint8_t>(next_random(random));
  }
  std::vector<ColorId> done;
  for (const ColorBox& box : boxes) {
    if (std::find(done.begin(), done.end(), box.color) != done.end()) continue;
    done.push_back(box.color);
    Value middle{};
    for (std::size_t i = 0; i < 3; ++i) middle[i] = static_cast<std::uint8_t>((box.low[i] + box.high[i]) / 2);
    values_.push_back(middle);
  }
}

std::size_t StressPatternCamera::value_at(std::size_t pattern, std::size_t u, std::size_t v,
                                          std::uint32_t& random) const {
  const std::size_t colors = values_.size() - 1;
  // Pixels that share a chroma sample cannot differ in color, so colors change only between samples.
  const ChannelLayout& chroma = info_of(parameters_.scan.format).channel[1];
  const std::size_t column = u >> chroma.shift_u, row = v >> chroma.shift_v;
  switch (pattern) {
    case 0:
      return 1;
    case 1:
      return 1 + (column + row) % std::min<std::size_t>(2, colors);
    case 2:
      return column % 2 == 0 && row % 2 == 0 ? 1 + (column / 2) % colors : 0;
    case 3:
      return column % 2 == 0 || v + 2u >= parameters_.scan.height_px ? 1 : 0;
    case 4:
      return next_random(random) % (colors + 1);
    case 5:
      // Blocks of two rows, which are too large to be removed as specks.
      return column % 3 < 2 && row % 3 < 2 ? 1 + (column / 3 + row / 3) % colors : 0;
    case 6:
      // Random colors in pairs of pixels; such pairs are also too large to be removed as specks.
      return position_hash(u / 2, row) % (colors + 1);
    case 7:
      // The share is slightly above the site percolation threshold of the square lattice, 0.5927, where clusters are
      // most ragged.
      return position_hash(column, row) % 1000 < 600 ? 1 : 0;
    default: {
      const std::size_t cell = u / kPatchPx + v / kPatchPx;
      return u % kPatchPx < kPatchPx - 2 && v % kPatchPx < kPatchPx - 2 ? 1 + cell % colors : 0;
    }
  }
}

template <class ValueAt>
void StressPatternCamera::fill(std::size_t pattern, ValueAt value_at) {
  const std::size_t width = info_.width_px, height = info_.height_px;
  const PictureLayout layout = picture_layout(info_.format, width, height);
  pictures_[pattern].assign(layout.bytes, 0);
  std::uint8_t* const first = pictures_[pattern].data();
  for (std::size_t v = 0; v < height; ++v) {
    for (std::size_t u = 0; u < width; ++u) {
      const PixelValue value = value_at(u, v);
      for (std::size_t c = 0; c < value.size(); ++c) {
        const ChannelLayout& channel = info_of(info_.format).channel[c];
        const std::size_t row =
            layout.offset_bytes[channel.plane] + (v >> channel.shift_v) * layout.stride_bytes[channel.plane];
        first[row + channel.byte(u)] = value[c];
      }
    }
  }
}

void StressPatternCamera::paint(std::size_t pattern) {
  std::uint32_t random = 7;
  fill(pattern, [&](std::size_t u, std::size_t v) { return values_[value_at(pattern, u, v, random)]; });
}

void StressPatternCamera::paint_clutter_picture(std::size_t number, const CameraModel& camera) {
  const std::optional<ClutterRecipe> recipe = clutter_recipe_of(worst_clutter()[number].recipe);
  const std::vector<PixelValue> picture =
      paint_clutter(recipe.value_or(ClutterRecipe{}), parameters_, camera, values_[0]);
  fill(kPatterns + number, [&](std::size_t u, std::size_t v) { return picture[v * info_.width_px + u]; });
}

Frame StressPatternCamera::frame_of(std::size_t pattern) const {
  Frame frame;
  frame.format = info_.format;
  frame.width_px = info_.width_px;
  frame.height_px = info_.height_px;
  const PictureLayout layout = picture_layout(info_.format, info_.width_px, info_.height_px);
  frame.stride_bytes = layout.stride_bytes;
  const std::uint8_t* data = pictures_[pattern].data();
  for (std::size_t i = 0; i < info_of(info_.format).planes; ++i) frame.plane[i] = data + layout.offset_bytes[i];
  return frame;
}

Result<void> StressPatternCamera::do_open() {
  const ScanParameters& scan = parameters_.scan;
  if (scan.boxes.empty()) {
    return failure(ErrorCode::kInconsistent,
                   "worst frames: the venue file has no colors; learn them with touchline-calibrate colors");
  }
  info_ = {scan.format, scan.width_px, scan.height_px, 0.0};
  choose_values();
  pictures_.resize(kPatterns + worst_clutter().size());
  for (std::size_t pattern = 0; pattern < kPatterns; ++pattern) paint(pattern);
  CameraModel camera;
  if (const Status s = camera.configure(parameters_.camera); !s.ok()) return Error{s.code(), describe(s.code())};
  for (std::size_t i = 0; i < worst_clutter().size(); ++i) paint_clutter_picture(i, camera);
  sequence_ = 0;
  return {};
}

Result<hal::FrameLease> StressPatternCamera::do_wait(Instant) {
  Frame frame = frame_of(sequence_ % pictures_.size());
  frame.capture_time = clock_.now();
  frame.sequence = sequence_++;
  return hal::FrameLease(*this, frame, 0);
}

}  // namespace touchline::latency
