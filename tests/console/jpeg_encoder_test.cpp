#include "firmware/console/jpeg_encoder.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <cstdio>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

#include "firmware/console/picture_scaler.h"
#include "tests/color/owned_picture.h"

namespace touchline::console {
namespace {

// Smooth, so that shared chroma and JPEG change little: all channels vary over the picture.
touchline::testing::OwnedPicture smooth_picture(PixelFormat format, int width, int height) {
  touchline::testing::OwnedPicture picture(format, width, height, 8);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      picture.set(u, v,
                  {static_cast<std::uint8_t>(40 + 150 * u / width), static_cast<std::uint8_t>(80 + 80 * v / height),
                   static_cast<std::uint8_t>(160 - 60 * u / width)});
    }
  }
  return picture;
}

struct DecodedJpeg {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
DecodedJpeg decode_jpeg(std::span<const std::byte> bytes) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);  // ends the test program on an error
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&jpeg);
  DecodedJpeg picture{jpeg.output_width, jpeg.output_height, {}};
  picture.rgb.resize(3 * picture.width * picture.height);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = picture.rgb.data() + std::size_t{3} * picture.width * jpeg.output_scanline;
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return picture;
}

class JpegEncoderTest : public ::testing::TestWithParam<PixelFormat> {};

TEST_P(JpegEncoderTest, GivesTheColorsOfThePictureInEverySize) {
  JpegEncoder encoder;
  std::vector<std::byte> out(1 << 20);
  for (const auto& [width, height] : std::vector<std::pair<int, int>>{{64, 48}, {65, 49}, {96, 33}, {200, 16}}) {
    const touchline::testing::OwnedPicture picture = smooth_picture(GetParam(), width, height);
    const Frame frame = picture.frame();
    for (const int divisor : {1, 2, 3, 8}) {
      const Result<std::size_t> size = encoder.encode(frame, divisor, 90, out);
      ASSERT_TRUE(size.ok()) << size.text();
      const DecodedJpeg decoded = decode_jpeg(std::span(out).first(size.value()));
      ASSERT_EQ(decoded.width, scaled(frame.width_px, divisor));
      ASSERT_EQ(decoded.height, scaled(frame.height_px, divisor));
      double difference = 0.0;
      for (std::size_t v = 0; v < decoded.height; ++v) {
        for (std::size_t u = 0; u < decoded.width; ++u) {
          const auto step = static_cast<std::size_t>(divisor);
          const auto expected =
              to_rgb8(pixel_at(frame, u * step + step / 2, v * step + step / 2), color_space(GetParam()));
          for (std::size_t c = 0; c < 3; ++c) {
            difference += std::abs(int{expected[c]} - int{decoded.rgb[3 * (v * decoded.width + u) + c]});
          }
        }
      }
      difference /= static_cast<double>(decoded.rgb.size());
      EXPECT_LT(difference, divisor == 8 ? 20.0 : 5.0) << width << " x " << height << " / " << divisor;
    }
  }
}

TEST_P(JpegEncoderTest, ABufferThatIsTooSmallIsAnErrorAndTheNextPictureIsFine) {
  JpegEncoder encoder;
  std::vector<std::byte> small(500), large(1 << 20);
  const touchline::testing::OwnedPicture picture = smooth_picture(GetParam(), 64, 48);
  EXPECT_EQ(encoder.encode(picture.frame(), 1, 90, small).code(), ErrorCode::kFull);
  EXPECT_TRUE(encoder.encode(picture.frame(), 1, 90, large).ok());
  const touchline::testing::OwnedPicture tiny = smooth_picture(GetParam(), 6, 6);
  EXPECT_EQ(encoder.encode(tiny.frame(), 8, 90, large).code(), ErrorCode::kOutOfRange);
}

// A console runs for days, so the library must free everything that it allocates for a picture, even after errors.
TEST_P(JpegEncoderTest, MemoryDoesNotGrowWithTheNumberOfPictures) {
  JpegEncoder encoder;
  std::vector<std::byte> small(500), out(1 << 20);
  const touchline::testing::OwnedPicture picture = smooth_picture(GetParam(), 320, 240);
  const auto encode_in_all_sizes = [&] {
    for (const int divisor : {1, 2, 4, 8}) {
      for (const int quality : {30, 80}) EXPECT_TRUE(encoder.encode(picture.frame(), divisor, quality, out).ok());
    }
    EXPECT_FALSE(encoder.encode(picture.frame(), 1, 80, small).ok());
  };
  encode_in_all_sizes();
  const std::size_t before = ::mallinfo2().uordblks;
  for (int i = 0; i < 20; ++i) encode_in_all_sizes();
  // Other threads of a test program may allocate a little.
  EXPECT_LT(::mallinfo2().uordblks, before + 4096);
}

INSTANTIATE_TEST_SUITE_P(Formats, JpegEncoderTest, ::testing::ValuesIn(touchline::testing::kAllFormats),
                         [](const auto& test) { return touchline::testing::name_of(test.param); });

}  // namespace
}  // namespace touchline::console
