#include "tests/benchmark/benchmark_case.h"

#include <cstring>

#include "core/cpu.h"
#include "tests/benchmark/field_picture.h"
#include "tests/region/patterns.h"

namespace touchline::testing {
namespace {

// Size of all copies together. It exceeds every cache, so each frame comes from memory, as from a camera's driver.
constexpr std::size_t kColdBytes = std::size_t{192} << 20;

// Returns the XOR of all bytes, computed in four independent accumulators of 32 bytes.
using Words [[gnu::vector_size(32)]] = std::uint64_t;
[[gnu::always_inline]] inline std::uint64_t sum_of(const std::uint8_t* bytes, std::size_t count) {
  Words sum[4] = {};
  std::size_t i = 0;
  for (; i + sizeof sum <= count; i += sizeof sum) {
    for (std::size_t k = 0; k < 4; ++k) {
      Words words;
      std::memcpy(&words, bytes + i + k * sizeof words, sizeof words);
      sum[k] ^= words;
    }
  }
  for (; i < count; ++i) sum[0][0] ^= bytes[i];
  const Words all = sum[0] ^ sum[1] ^ sum[2] ^ sum[3];
  return all[0] ^ all[1] ^ all[2] ^ all[3];
}
std::uint64_t read_portable(const std::uint8_t* bytes, std::size_t count) { return sum_of(bytes, count); }
#if defined(__x86_64__)
TOUCHLINE_AVX2 std::uint64_t read_avx2(const std::uint8_t* bytes, std::size_t count) { return sum_of(bytes, count); }
#else
std::uint64_t read_avx2(const std::uint8_t* bytes, std::size_t count) { return sum_of(bytes, count); }
#endif

// levels of noise, assumed
constexpr double kFloorTexture = 7.0;

BenchmarkCase case_of(OwnedPicture picture, const ScanParameters& parameters) {
  return {.name = {}, .picture = std::move(picture), .parameters = parameters};
}

// the default of venue files
constexpr std::uint32_t kDefaultMinArea_px = 2;

BenchmarkCase field(const FieldScene& scene) {
  BenchmarkCase benchmark = case_of(paint_field(scene), field_parameters(scene));
  benchmark.parameters.min_area_px = kDefaultMinArea_px;
  return benchmark;
}

BenchmarkCase with_slow_methods(BenchmarkCase benchmark) {
  benchmark.slow_methods = true;
  return benchmark;
}

BenchmarkCase uncached(BenchmarkCase benchmark) {
  const Frame frame = benchmark.picture.frame();
  std::size_t bytes = 0;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) bytes += plane_bytes(frame, plane);
  benchmark.copies.assign(kColdBytes / bytes + 1, benchmark.picture);
  return benchmark;
}

BenchmarkCase shaded(BenchmarkCase benchmark) {
  LightMap& light = benchmark.parameters.light;
  light.columns = 64, light.rows = 48;
  for (auto& plane : light.illumination) {
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = 0.85f + 0.3f * static_cast<float>(i % 64) / 64.0f;
  }
  return benchmark;
}

}  // namespace

Frame BenchmarkCase::next_frame() {
  if (copies.empty()) return picture.frame();
  turn = (turn + 1) % copies.size();
  return copies[turn].frame();
}

std::uint64_t read_frame(const Frame& frame) {
  std::uint64_t sum = 0;
  for (std::size_t plane = 0; plane < kMaxPlanes; ++plane) {
    const auto read = cpu_supports(KernelChoice::kAvx2) ? read_avx2 : read_portable;
    sum ^= read(frame.plane[plane], plane_bytes(frame, plane));
  }
  return sum;
}

BenchmarkCase many_colors_case(const ColorGrid& grid, std::uint32_t min_area_px) {
  std::mt19937 random(7);
  OwnedPicture picture = paint(grid, PixelFormat::kRgb24, 0, random);
  ScanParameters parameters = parameters_for(picture.frame());
  parameters.min_area_px = min_area_px;
  // Adds eight classes between those of the palette, which no pixel has. They are interleaved with the palette's
  // classes, so that kernels that process eight classes at a time find pixels in each group of eight.
  const ColorBoxes palette = parameters.boxes;
  parameters.boxes.clear();
  for (std::size_t i = 0; i < palette.size(); ++i) {
    parameters.boxes.push_back(palette[i]);
    for (std::size_t k = 0; k < 2 && parameters.boxes.size() < 13; ++k) {
      ColorBox box = palette[i];
      box.low[0] = static_cast<std::uint8_t>(palette[i].high[0] + 1 + 5 * k);
      box.high[0] = static_cast<std::uint8_t>(box.low[0] + 4);
      box.color = static_cast<ColorId>(palette.size() + 1 + 2 * i + k);
      parameters.boxes.push_back(box);
    }
  }
  BenchmarkCase benchmark = case_of(std::move(picture), parameters);
  benchmark.colors = grid;
  return benchmark;
}

std::vector<std::unique_ptr<BenchmarkCase>> make_cases(std::string_view part) {
  std::vector<std::unique_ptr<BenchmarkCase>> cases;
  const auto add = [&](const std::string& name, const auto& make) {
    if (name.find(part) == std::string::npos) return;
    cases.push_back(std::make_unique<BenchmarkCase>(make()));
    cases.back()->name = name;
  };
  const FieldScene vga;
  FieldScene yuyv = vga, nv12 = vga, noisy = vga, textured = vga, large = vga, full_hd = vga;
  yuyv.format = PixelFormat::kYuyv;
  nv12.format = PixelFormat::kNv12;
  noisy.noise = 8.0;
  noisy.specks_per_megapixel = 3000 / (640 * 480e-6);
  textured.texture = kFloorTexture;
  large.width_px = 1280, large.height_px = 1024;
  full_hd.width_px = 1920, full_hd.height_px = 1080;
  add("field 640x480 rgb24", [&] { return with_slow_methods(field(vga)); });
  add("field 640x480 rgb24, cold", [&] { return uncached(field(vga)); });
  add("field 640x480 rgb24, light map", [&] { return shaded(field(vga)); });
  add("field 640x480 rgb24, noisy", [&] { return field(noisy); });
  add("field 640x480 rgb24, textured", [&] { return field(textured); });
  add("field 640x480 yuyv", [&] { return field(yuyv); });
  add("field 640x480 nv12", [&] { return field(nv12); });
  add("field 1280x1024 rgb24", [&] { return field(large); });
  add("field 1920x1080 rgb24", [&] { return field(full_hd); });
  for (const Pattern pattern : kAllPatterns) {
    for (const std::uint32_t min_area : {1u, kDefaultMinArea_px}) {
      const std::string name = std::string(name_of(pattern)) + (min_area == 1 ? "" : kSpecksLeftOut);
      add(name, [&] {
        std::mt19937 random(7);
        return many_colors_case(make_pattern(pattern, 640, 480, random), min_area);
      });
    }
  }
  return cases;
}

}  // namespace touchline::testing
