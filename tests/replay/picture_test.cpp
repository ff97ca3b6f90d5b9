#include "hal/replay/picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "tests/replay/media.h"

namespace touchline {
namespace {

using hal::Picture;

// Reads a file that must be refused; returns the message, and checks that nothing was printed.
std::string refused(const std::string& path, ErrorCode expected) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const Result<Picture> read = hal::read_picture(path);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(read.code(), expected) << path << ": " << read.text();
  EXPECT_NE(read.text().find(path), std::string::npos) << "the message must name the file: " << read.text();
  return read.text();
}

Picture read(const std::string& path) {
  Result<Picture> picture = hal::read_picture(path);
  EXPECT_TRUE(picture.ok()) << picture.text();
  return picture.ok() ? std::move(picture).value() : Picture();
}

TEST(Picture, EightBitsSurvivePng) {
  const media::Folder folder;
  const Picture written = media::colorful(37, 23);
  media::write_png(folder / "a.png", written);
  const Picture picture = read(folder / "a.png");
  EXPECT_EQ(picture.width_px, 37u);
  EXPECT_EQ(picture.height_px, 23u);
  EXPECT_FALSE(picture.is_16_bit());
  EXPECT_EQ(picture.rgb8, written.rgb8);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "no temporary file is left";
}

TEST(Picture, SixteenBitsSurvivePng) {
  const media::Folder folder;
  Picture written{5, 4, {}, {}};
  for (std::uint32_t i = 0; i < 60; ++i) written.rgb16.push_back(static_cast<std::uint16_t>(i * 1109u + 7u));
  media::write_png(folder / "deep.png", written);
  const Picture picture = read(folder / "deep.png");
  EXPECT_TRUE(picture.is_16_bit());
  EXPECT_EQ(picture.rgb16, written.rgb16);
}

TEST(Picture, PpmAndPgmAreRead) {
  const media::Folder folder;
  media::write_text(folder / "a.ppm", "P6\n# a comment\n2 1\n255\n\x01\x02\x03\xfd\xfe\xff");
  EXPECT_EQ(read(folder / "a.ppm").rgb8, (std::vector<std::uint8_t>{1, 2, 3, 253, 254, 255}));
  media::write_text(folder / "grey.pgm", "P5 2 1 255\n\x10\xf0");
  EXPECT_EQ(read(folder / "grey.pgm").rgb8, (std::vector<std::uint8_t>{16, 16, 16, 240, 240, 240}));
  const std::string deep("P6 1 1 65535\n\x12\x34\x56\x78\x9a\xbc");
  media::write_text(folder / "deep.ppm", deep);
  EXPECT_EQ(read(folder / "deep.ppm").rgb16, (std::vector<std::uint16_t>{0x1234, 0x5678, 0x9abc}));
}

TEST(Picture, PnmOfAnyDepthAndAsTextIsRead) {
  const media::Folder folder;
  media::write_text(folder / "a.ppm", "P3 2 1 # depth\n100\n0 50 100\n1 99 2\n");
  EXPECT_EQ(read(folder / "a.ppm").rgb8, (std::vector<std::uint8_t>{0, 128, 255, 3, 252, 5}));
  media::write_text(folder / "a.pgm", "P2\n2 1\n1023\n0\n1023");
  EXPECT_EQ(read(folder / "a.pgm").rgb16, (std::vector<std::uint16_t>{0, 0, 0, 65535, 65535, 65535}));
  media::write_text(folder / "bright.ppm", "P3 1 1 100 0 0 101");
  refused(folder / "bright.ppm", ErrorCode::kCorruptFrame);
  media::write_text(folder / "short.ppm", "P3 2 1 9 1 2 3 4 5");
  refused(folder / "short.ppm", ErrorCode::kCorruptFrame);
  media::write_text(folder / "deep.ppm", "P6 1 1 65536\n123456");
  refused(folder / "deep.ppm", ErrorCode::kCorruptFrame);
}

// Written by libpng's simple interface.
TEST(Picture, EveryKindOfPngIsRead) {
  const media::Folder folder;
  const auto file_of = [&](png_uint_32 format, const std::vector<std::uint8_t>& pixels, const void* palette = nullptr) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = 2;
    image.height = 1;
    image.format = format;
    image.colormap_entries = palette == nullptr ? 0 : 2;
    const std::string path = folder / "a.png";
    EXPECT_NE(png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, palette), 0) << image.message;
    return path;
  };
  using Values = std::vector<std::uint8_t>;
  EXPECT_EQ(read(file_of(PNG_FORMAT_GRAY, {7, 250})).rgb8, (Values{7, 7, 7, 250, 250, 250}));
  EXPECT_EQ(read(file_of(PNG_FORMAT_GA, {7, 0, 250, 128})).rgb8, (Values{7, 7, 7, 250, 250, 250}));
  EXPECT_EQ(read(file_of(PNG_FORMAT_RGBA, {1, 2, 3, 0, 4, 5, 6, 128})).rgb8, (Values{1, 2, 3, 4, 5, 6}));
  // One bit per pixel, and transparent colors.
  const std::array<std::uint8_t, 8> palette{10, 20, 30, 255, 40, 50, 60, 0};
  EXPECT_EQ(read(file_of(PNG_FORMAT_RGBA_COLORMAP, {1, 0}, palette.data())).rgb8, (Values{40, 50, 60, 10, 20, 30}));
}

TEST(Picture, EveryKindOfJpegIsRead) {
  const media::Folder folder;
  Picture flat{32, 32, {}, {}};
  for (int i = 0; i < 32 * 32; ++i) flat.rgb8.insert(flat.rgb8.end(), {200, 60, 30});
  for (const media::JpegKind kind : {media::JpegKind::k422, media::JpegKind::kProgressive}) {
    media::write_jpeg(folder / "a.jpg", flat, kind);
    const Picture picture = read(folder / "a.jpg");
    ASSERT_EQ(picture.rgb8.size(), flat.rgb8.size());
    for (std::size_t i = 0; i < picture.rgb8.size(); ++i) {
      ASSERT_LE(std::abs(picture.rgb8[i] - flat.rgb8[i]), 3) << "value " << i;
    }
  }
  media::write_jpeg(folder / "gray.jpg", flat, media::JpegKind::kGray);
  const Picture gray = read(folder / "gray.jpg");
  ASSERT_EQ(gray.rgb8.size(), flat.rgb8.size());
  EXPECT_NEAR(gray.rgb8[0], 0.299 * 200 + 0.587 * 60 + 0.114 * 30, 2);
  EXPECT_TRUE(gray.rgb8[0] == gray.rgb8[1] && gray.rgb8[1] == gray.rgb8[2]);
  media::write_jpeg(folder / "printer.jpg", flat, media::JpegKind::kCmyk);
  EXPECT_NE(refused(folder / "printer.jpg", ErrorCode::kUnsupported).find("CMYK"), std::string::npos);
}

TEST(Picture, JpegKeepsTheColors) {
  const media::Folder folder;
  Picture flat{32, 32, {}, {}};
  for (int i = 0; i < 32 * 32; ++i) flat.rgb8.insert(flat.rgb8.end(), {200, 60, 30});
  media::write_jpeg(folder / "a.jpg", flat);
  const Picture picture = read(folder / "a.jpg");
  ASSERT_EQ(picture.rgb8.size(), flat.rgb8.size());
  for (std::size_t i = 0; i < picture.rgb8.size(); ++i) {
    ASSERT_LE(std::abs(picture.rgb8[i] - flat.rgb8[i]), 3) << "value " << i;
  }
}

TEST(Picture, TruncatedPngIsRefused) {
  const media::Folder folder;
  media::write_png(folder / "whole.png", media::colorful(64, 48));
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "whole.png");
  ASSERT_GT(whole.size(), 5000u);
  for (std::size_t percent = 1; percent < 100; percent += 3) {
    media::write_bytes(folder / "cut.png",
                       std::span(whole).first(std::max<std::size_t>(8, whole.size() * percent / 100)));
    refused(folder / "cut.png", ErrorCode::kCorruptFrame);
  }
  // The last chunk has 12 bytes and contains no pixel, but without it the file is incomplete.
  for (std::size_t missing = 1; missing <= 16; ++missing) {
    media::write_bytes(folder / "cut.png", std::span(whole).first(whole.size() - missing));
    refused(folder / "cut.png", ErrorCode::kCorruptFrame);
  }
}

TEST(Picture, PngWithOneWrongBitIsRefused) {
  const media::Folder folder;
  media::write_png(folder / "whole.png", media::colorful(64, 48));
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "whole.png");
  for (std::size_t position = 60; position + 60 < whole.size(); position += 997) {
    std::vector<std::uint8_t> bytes = whole;
    bytes[position] ^= 0x10u;
    media::write_bytes(folder / "bent.png", bytes);
    refused(folder / "bent.png", ErrorCode::kCorruptFrame);
  }
}

// Chunks and checksums are right, but rows are missing: only the decoder can detect that.
TEST(Picture, PngWithTooFewRowsIsRefused) {
  const media::Folder folder;
  media::write_png(folder / "whole.png", media::colorful(64, 48));
  std::vector<std::uint8_t> bytes = media::read_bytes(folder / "whole.png");
  bytes[23] = 60;  // height, last byte: IHDR begins at 12, its data at 16
  const std::uint32_t crc = media::crc32(std::span(bytes).subspan(12, 17));
  for (std::size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
  media::write_bytes(folder / "short.png", bytes);
  refused(folder / "short.png", ErrorCode::kCorruptFrame);
}

TEST(Picture, TruncatedJpegIsRefused) {
  const media::Folder folder;
  media::write_jpeg(folder / "whole.jpg", media::colorful(64, 48));
  const std::vector<std::uint8_t> whole = media::read_bytes(folder / "whole.jpg");
  for (std::size_t percent = 10; percent < 100; percent += 10) {
    media::write_bytes(folder / "cut.jpg", std::span(whole).first(whole.size() * percent / 100));
    refused(folder / "cut.jpg", ErrorCode::kCorruptFrame);
  }
  media::write_bytes(folder / "cut.jpg", std::span(whole).first(whole.size() - 2));
  refused(folder / "cut.jpg", ErrorCode::kCorruptFrame);
}

TEST(Picture, TruncatedPpmIsRefused) {
  const media::Folder folder;
  media::write_text(folder / "cut.ppm", "P6 2 2 255\n12345678901");
  refused(folder / "cut.ppm", ErrorCode::kCorruptFrame);
  media::write_text(folder / "head.ppm", "P6 2");
  refused(folder / "head.ppm", ErrorCode::kCorruptFrame);
}

// Under a memory limit (LimitDATA= of the service), allocating the pixels of such a file could fail.
TEST(Picture, TooManyPixelsAreRefusedBeforeMemoryIsAllocated) {
  const media::Folder folder;
  media::write_png(folder / "large.png", media::colorful(64, 48));
  std::vector<std::uint8_t> bytes = media::read_bytes(folder / "large.png");
  const std::array<std::uint8_t, 9> size_and_depth{0, 0, 0x2e, 0xe0, 0, 0, 0x23, 0x28, 16};  // 12000 x 9000, 16 bits
  std::copy(size_and_depth.begin(), size_and_depth.end(), bytes.begin() + 16);
  const std::uint32_t crc = media::crc32(std::span(bytes).subspan(12, 17));
  for (std::size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
  media::write_bytes(folder / "large.png", bytes);
  const std::string reason = refused(folder / "large.png", ErrorCode::kOutOfRange);
  EXPECT_NE(reason.find("more than 20155392 pixels"), std::string::npos) << reason;
  media::write_text(folder / "large.ppm", "P6 12000 9000 65535\n");
  refused(folder / "large.ppm", ErrorCode::kOutOfRange);
  // The size of a JPEG is in its SOF segment: FF C0, length, precision, height, width.
  media::write_jpeg(folder / "large.jpg", media::colorful(64, 48));
  bytes = media::read_bytes(folder / "large.jpg");
  const std::array<std::uint8_t, 2> marker{0xff, 0xc0};
  const auto sof = std::search(bytes.begin(), bytes.end(), marker.begin(), marker.end());
  ASSERT_NE(sof, bytes.end());
  const std::array<std::uint8_t, 4> height_and_width{0x23, 0x28, 0x2e, 0xe0};
  std::copy(height_and_width.begin(), height_and_width.end(), sof + 5);
  bytes.resize(std::size_t{500} * 1024);  // a file with fewer bytes than blocks would be refused as damaged
  media::write_bytes(folder / "large.jpg", bytes);
  refused(folder / "large.jpg", ErrorCode::kOutOfRange);
}

TEST(Picture, FilesThatAreNotPicturesAreRefused) {
  const media::Folder folder;
  EXPECT_NE(refused(folder / "missing.png", ErrorCode::kNotFound).find("no such file"), std::string::npos);
  media::write_text(folder / "empty.png", "");
  EXPECT_NE(refused(folder / "empty.png", ErrorCode::kCorruptFrame).find("empty"), std::string::npos);
  media::write_text(folder / "text.png", "these are words, not pixels");
  refused(folder / "text.png", ErrorCode::kUnsupported);
  refused(folder.path(), ErrorCode::kUnsupported);
}

TEST(Picture, WriteErrorsAreReported) {
  const media::Folder folder;
  EXPECT_EQ(hal::write_picture(folder / "a.png", {}).code(), ErrorCode::kOutOfRange);
  Picture short_one = media::colorful(4, 4);
  short_one.rgb8.pop_back();
  EXPECT_EQ(hal::write_picture(folder / "a.png", short_one).code(), ErrorCode::kOutOfRange);
  const Result<void> written = hal::write_picture(folder / "none/a.png", media::colorful(4, 4));
  EXPECT_EQ(written.code(), ErrorCode::kNotFound);
  EXPECT_NE(written.text().find("none/a.png"), std::string::npos) << written.text();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace touchline
