#include "core/marker/pixel_rows.h"

#include <gtest/gtest.h>

#include <random>

#include "core/marker/surface_color.h"
#include "tests/color/owned_picture.h"

namespace touchline::testing {
namespace {

// The picture's bytes end with its last pixel: the address sanitizer sees if more are read.
TEST(PixelRows, ReadsEveryPixelOfAllFormats) {
  constexpr int kWidth = 13;
  constexpr std::size_t kColumns = kWidth;
  for (const PixelFormat format : kAllFormats) {
    for (const int height : {1, 2, 5}) {
      OwnedPicture picture(format, kWidth, height, 5);
      std::mt19937 random(1);
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < kWidth; ++u) {
          const auto value = [&random] { return static_cast<std::uint8_t>(random() % 256); };
          picture.set(u, v, {value(), value(), value()});
        }
      }
      const Frame frame = picture.frame();
      PixelRows<kColumns> rows(frame);
      for (std::size_t i = 0; i < kColumns; ++i) rows.set_column(i, i);
      for (std::size_t v = 0; v < frame.height_px; ++v) {
        rows.select(v);
        const auto expect = [&](const std::array<Simd4<float>, 3>& four, std::size_t first, std::size_t every) {
          for (std::size_t lane = 0; lane < 4; ++lane) {
            const std::array<std::uint8_t, 3> pixel = pixel_at(frame, first + every * lane, v);
            const auto rgb =
                to_rgb({static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(pixel[2])},
                       color_space(format));
            for (std::size_t c = 0; c < 3; ++c) {
              EXPECT_EQ(four[c][lane], rgb[c]) << name_of(format) << " " << first + every * lane << ", " << v;
            }
          }
        };
        for (std::size_t first = 0; first + 4 <= kColumns; ++first) expect(rows.read<1>(first), first, 1);
        for (std::size_t first = 0; first + 7 <= kColumns; ++first) expect(rows.read<2>(first), first, 2);
      }
    }
  }
}

}  // namespace
}  // namespace touchline::testing
