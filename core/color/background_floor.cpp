#include "core/color/background_floor.h"

#include <algorithm>

#include "core/color/load_word.h"

namespace touchline {
namespace {

constexpr std::uint16_t kNever = 256;

// Which channel byte `byte` of a block belongs to.
std::size_t channel_of_byte(PixelFormat format, std::size_t byte) {
  switch (format) {
    case PixelFormat::kRgb24:
      return byte % 3;
    case PixelFormat::kBgr24:
      return 2 - byte % 3;
    case PixelFormat::kYuyv:
      return byte % 2 == 0 ? 0 : 1 + byte / 2 % 2;
    case PixelFormat::kUyvy:
      return byte % 2 == 1 ? 0 : 1 + byte / 2 % 2;
    case PixelFormat::kNv12:
      return byte < kBlockPixels ? 0 : 1 + byte % 2;
  }
  return 0;
}

// What the third channel's floor can be at most once those of the first two are chosen.
std::uint16_t third_floor(const ColorBoxes& boxes, std::uint16_t first, std::uint16_t second) {
  std::uint16_t floor = kNever;
  for (const ColorBox& box : boxes) {
    if (box.low[0] < first && box.low[1] < second) floor = std::min<std::uint16_t>(floor, box.low[2]);
  }
  return floor;
}

}  // namespace

ChannelFloors floors_of(const ColorBoxes& boxes) {
  // An optimal floor is a low bound of some box or 256, and the third follows from the other two.
  using Candidates = FixedVector<std::uint16_t, kMaxColorBoxes + 1>;
  std::array<Candidates, 2> candidates;
  for (std::size_t channel = 0; channel < 2; ++channel) {
    candidates[channel].push_back(kNever);
    for (const ColorBox& box : boxes) candidates[channel].push_back(box.low[channel]);
  }
  ChannelFloors best{};
  std::uint32_t best_volume = 0;
  for (const std::uint16_t first : candidates[0]) {
    for (const std::uint16_t second : candidates[1]) {
      const std::uint16_t third = third_floor(boxes, first, second);
      const std::uint32_t volume = std::uint32_t{first} * second * third;
      if (volume <= best_volume) continue;
      best_volume = volume;
      best = {first, second, third};
    }
  }
  return best;
}

std::uint16_t floor_before_correction(std::uint16_t floor, std::uint8_t level, std::uint8_t unlit) {
  if (floor >= kNever) return kNever;
  std::uint16_t value = 0;
  while (value < kFullScale && corrected(static_cast<std::uint8_t>(value), level, unlit) < floor) ++value;
  return value;
}

BackgroundFloor::BackgroundFloor(PixelFormat format, const ChannelFloors& floors) {
  for (std::size_t word = 0; word < words(format); ++word) {
    std::array<std::uint8_t, 8> addend{}, either{};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::uint16_t floor = floors[channel_of_byte(format, word * 8 + i)];
      addend[i] = static_cast<std::uint8_t>((floor <= 128 ? 128 : 256) - floor);
      either[i] = floor <= 128 ? 0x80 : 0;
    }
    addend_[word] = load_word(addend.data());
    either_[word] = load_word(either.data());
  }
  can_reject_ = *std::min_element(floors.begin(), floors.end()) > 0;
  if (!can_reject_ || color_space(format) != ColorSpace::kRgb) return;
  for (std::size_t byte = 0; byte < highest_below_.size(); ++byte) {
    highest_below_[byte] = static_cast<std::uint8_t>(floors[channel_of_byte(format, byte)] - 1);
  }
}

}  // namespace touchline
