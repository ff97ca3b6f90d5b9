#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "core/color/background_box.h"
#include "core/region/region_scanner.h"
#include "tests/benchmark/field_picture.h"

namespace {

using namespace touchline;
using namespace touchline::testing;

constexpr std::array<std::uint8_t, 3> kNeutral = {kNeutralLevel, kNeutralLevel, kNeutralLevel};

bool is_background(const BackgroundBox& box, const Channels& value) {
  bool inside = box.exists;
  for (std::size_t c = 0; c < 3; ++c) inside = inside && box.low[c] <= value[c] && value[c] <= box.high[c];
  return inside;
}

// A value out of the background box with a high nibble that no color has in some channel: `within` tells it.
Channels decided_by_high_nibbles(const ScanParameters& parameters) {
  const BackgroundBox box = find_background_box(parameters.boxes, color_space(parameters.format));
  const auto in_a_color = [&](const Channels& value) {
    for (const ColorBox& color : parameters.boxes) {
      bool near = true;
      for (std::size_t c = 0; c < 3; ++c)
        near = near && color.low[c] / 16 <= value[c] / 16 && value[c] / 16 <= color.high[c] / 16;
      if (near) return true;
    }
    return false;
  };
  std::mt19937 random(1);
  Channels value{};
  do {
    for (std::uint8_t& channel : value) channel = static_cast<std::uint8_t>(random());
  } while (is_background(box, value) || in_a_color(value));
  return value;
}

// background, nibbles and colors: every pixel ends in that step of a kernel; colors has all classes in every tile.
OwnedPicture paint(const std::string& name, const FieldScene& scene, const ScanParameters& parameters) {
  if (name == "field") return paint_field(scene);
  OwnedPicture picture(scene.format, scene.width_px, scene.height_px, 0);
  Channels value = {0, 0, 0};
  for (std::size_t c = 0; c < 3; ++c) value[c] = black_value(color_space(scene.format), c);
  if (name == "nibbles") value = decided_by_high_nibbles(parameters);
  for (int v = 0; v < scene.height_px; ++v) {
    for (int u = 0; u < scene.width_px; ++u) {
      if (name == "colors") {
        const ColorBox& box = parameters.boxes[static_cast<std::size_t>(u / 2) % parameters.boxes.size()];
        for (std::size_t c = 0; c < 3; ++c) value[c] = static_cast<std::uint8_t>((box.low[c] + box.high[c]) / 2);
      }
      picture.set(u, v, value);
    }
  }
  return picture;
}

// A lamp in the middle.
LightMap lamp() {
  LightMap light;
  light.columns = 5;
  light.rows = 4;
  for (auto& plane : light.illumination) {
    for (std::size_t i = 0; i < 20; ++i) {
      const auto column = static_cast<float>(i % 5) - 2.0f, row = static_cast<float>(i / 5) - 1.5f;
      plane[i] = 1.05f - 0.02f * (column * column + row * row);
    }
  }
  return light;
}

// Where the emulator's log begins and ends to count.
extern "C" [[gnu::noinline]] void trace_begins() { asm volatile(""); }
extern "C" [[gnu::noinline]] void trace_ends() { asm volatile(""); }

}  // namespace

// scan_field FORMAT PICTURE KERNEL LIGHT WORK: a call of WORK, scan or classify, on a 640 x 480 picture between two
// marks. Prints how many regions or colored pixels it found.
int main(int argc, char** argv) {
  if (argc != 6) return 64;
  const std::string picture_name = argv[2], kernel_name = argv[3], light_name = argv[4], work = argv[5];
  FieldScene scene;
  for (const PixelFormat format : kAllFormats) {
    if (std::string(argv[1]) == name_of(format)) scene.format = format;
  }
  ScanParameters parameters = field_parameters(scene);
  parameters.min_area_px = 2;
  for (const auto& choice : kKernelChoices) {
    if (kernel_name == choice.word) parameters.kernel = choice.value;
  }
  if (light_name == "map") parameters.light = lamp();
  const OwnedPicture picture = paint(picture_name, scene, parameters);
  const Frame frame = picture.frame();
  std::size_t found = 0;
  if (work == "scan") {
    const auto scanner = std::make_unique<RegionScanner>();
    const auto runs = std::make_unique<Runs>();
    const auto regions = std::make_unique<Regions>();
    if (!scanner->configure(parameters).ok()) return 70;
    trace_begins();
    const Status status = scanner->scan(frame, *runs, *regions);
    trace_ends();
    if (!status.ok()) return 70;
    found = regions->size();
  } else {
    const auto classifier = std::make_unique<RowClassifier>();
    if (!classifier
             ->configure(scene.format, frame.width_px, frame.height_px, parameters.boxes, parameters.light,
                         parameters.kernel)
             .ok())
      return 70;
    std::vector<ColorId> colors(frame.width_px);
    for (std::uint16_t v = 0; v < frame.height_px; ++v) {
      trace_begins();
      classifier->classify(frame, v, 0, frame.width_px, colors.data());
      trace_ends();
      found += colors.size() - static_cast<std::size_t>(std::count(colors.begin(), colors.end(), kBackground));
    }
  }
  std::printf("%zu\n", found);
}
