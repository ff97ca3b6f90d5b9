#include <algorithm>
#include <array>
#include <random>

#include "core/types.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "tests/color/owned_picture.h"
#include "tests/linux/driver_allocations.h"
#include "tests/linux/jpeg_encoder.h"
#include "tests/linux/jpeg_picture.h"
#include "tests/linux/v4l2_fixture.h"
#include "tests/results.h"

namespace touchline::testing {
namespace {

using hal::CameraFormat;
using hal::FrameLease;
using hal::MjpgDecoder;

constexpr const char* kCutOff = "Corrupt JPEG data: premature end of data segment";

// Contents of the 8 x 8 blocks: noise, so that neighboring samples differ; or blocks of one color, some of them full
// black, white or saturated, among which every fifth is noise.
enum class Blocks { kNoise, kMostlyFlat };

std::vector<std::uint8_t> random_jpeg(const JpegStyle& style, Blocks blocks, int quality) {
  std::mt19937 random(5);
  const auto set_up = [&](jpeg_compress_struct& jpeg) {
    jpeg_set_quality(&jpeg, quality, TRUE);
    jpeg.comp_info[0].h_samp_factor = style.horizontal;
    jpeg.comp_info[0].v_samp_factor = style.vertical;
    jpeg.optimize_coding = style.own_huffman_tables ? TRUE : FALSE;
    jpeg.restart_in_rows = style.with_restarts ? 1 : 0;
  };
  std::vector<Channels> color_of;
  return encode_jpeg(style.width, style.height, set_up, [&](unsigned v, std::span<std::uint8_t> row) {
    for (unsigned u = 0; u < style.width; ++u) {
      const std::size_t block = u / 32;  // as large as the block of a sample that belongs to four pixels
      if (u % 32 == 0 && v % 32 == 0) {
        if (u == 0) color_of.clear();
        Channels color{};
        for (std::uint8_t& value : color) {
          value = static_cast<std::uint8_t>(std::clamp(static_cast<int>(random() % 512) - 128, 0, 255));
        }
        color_of.push_back(color);
      }
      const bool is_noise = blocks == Blocks::kNoise || (v / 32 + block) % 5 == 0;
      for (std::size_t c = 0; c < 3; ++c) {
        row[3 * std::size_t{u} + c] = is_noise ? static_cast<std::uint8_t>(random()) : color_of[block][c];
      }
    }
  });
}

// Y, U, V of each pixel, without interpolation.
std::vector<Channels> yuv_of_jpeg(const std::vector<std::uint8_t>& bytes) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = JCS_YCbCr;
  jpeg.dct_method = JDCT_ISLOW;
  jpeg.do_fancy_upsampling = FALSE;
  jpeg_start_decompress(&jpeg);
  std::vector<Channels> pixels(std::size_t{jpeg.output_width} * jpeg.output_height);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = pixels[std::size_t{jpeg.output_scanline} * jpeg.output_width].data();
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return pixels;
}

class MjpgDecoderTest : public ::testing::Test {
 protected:
  void begin(const JpegStyle& style = {}) {
    decoder_.open(static_cast<std::uint16_t>(style.width), static_cast<std::uint16_t>(style.height));
    picture_.assign(decoder_.layout().bytes + kGuard, 77);
    frame_ = {};
    frame_.format = PixelFormat::kYuvj422p;
    frame_.width_px = static_cast<std::uint16_t>(style.width);
    frame_.height_px = static_cast<std::uint16_t>(style.height);
    frame_.stride_bytes = decoder_.layout().stride_bytes;
    for (std::size_t i = 0; i < kMaxPlanes; ++i) frame_.plane[i] = picture_.data() + decoder_.layout().offset_bytes[i];
  }
  [[nodiscard]] Channels rgb_at(unsigned u, unsigned v) const {
    return to_rgb8(pixel_at(frame_, u, v), ColorSpace::kYuvFullRange);
  }
  void expect_nothing_beyond_the_picture() {
    for (std::size_t i = picture_.size() - kGuard; i < picture_.size(); ++i) ASSERT_EQ(picture_[i], 77) << i;
  }
  void expect_picture(const JpegStyle& style, const std::vector<std::uint8_t>& jpeg) {
    ASSERT_OK(decoder_.decode(jpeg, picture_.data()));
    for (const unsigned u : {3u, style.width / 4, style.width - 4}) {
      for (const unsigned v : {3u, style.height / 4, style.height - 4}) {
        const std::array<int, 3> color = color_at(style, u, v);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(rgb_at(u, v)[c], color[c], 6) << u << ", " << v << ", " << c;
      }
    }
    expect_nothing_beyond_the_picture();
  }
  void expect_samples_of_the_file(const JpegStyle& style, const std::vector<std::uint8_t>& jpeg) {
    begin(style);
    ASSERT_OK(decoder_.decode(jpeg, picture_.data()));
    const std::vector<Channels> expected = yuv_of_jpeg(jpeg);
    ASSERT_EQ(expected.size(), std::size_t{style.width} * style.height);
    for (unsigned v = 0; v < style.height; ++v) {
      for (unsigned u = 0; u < style.width; ++u) {
        const std::size_t row = std::size_t{v} * style.width;
        const Channels first = expected[row + u / 2 * 2],
                       second = expected[row + std::min(style.width - 1, u / 2 * 2 + 1)];
        const Channels found = pixel_at(frame_, u, v);
        ASSERT_EQ(found[0], expected[row + u][0]) << u << ", " << v;
        for (std::size_t c = 1; c < 3; ++c) {
          ASSERT_EQ(found[c], (first[c] + second[c] + 1) / 2)
              << u << ", " << v << ", " << style.horizontal << style.vertical;
        }
      }
    }
    expect_nothing_beyond_the_picture();
  }
  void expect_damage(const std::vector<std::uint8_t>& jpeg, const std::string& reason) {
    expect_error(decoder_.decode(jpeg, picture_.data()), ErrorCode::kCorruptFrame, reason);
  }

  static constexpr std::size_t kGuard = 64;
  MjpgDecoder decoder_;
  std::vector<std::uint8_t> picture_;
  Frame frame_;
};

TEST_F(MjpgDecoderTest, DecodesTheFormatsOfCamerasInFullRange) {
  const std::array<JpegStyle, 8> styles{{{},
                                         {.horizontal = 2, .vertical = 2},
                                         {.horizontal = 1, .vertical = 1},
                                         {.horizontal = 1, .vertical = 2},
                                         {.horizontal = 4, .vertical = 1},
                                         {.gray = true},
                                         {.with_huffman_tables = false},
                                         {.width = 157, .height = 101, .horizontal = 2, .vertical = 2}}};
  for (const JpegStyle& style : styles) {
    begin(style);
    expect_picture(style, jpeg_of(style));
    expect_picture(style, jpeg_of(style));
  }
}

// Compares every sample with those that the library itself repeats for each pixel.
TEST_F(MjpgDecoderTest, SamplesAreThoseOfTheFile) {
  for (const auto& [width, height] : {std::pair{157u, 101u}, {160u, 96u}, {16u, 16u}, {33u, 17u}, {1000u, 50u}}) {
    for (const auto& [horizontal, vertical] : {std::pair{2, 1}, {2, 2}, {1, 1}, {1, 2}, {4, 1}, {4, 2}, {2, 4}}) {
      const JpegStyle style{.width = width, .height = height, .horizontal = horizontal, .vertical = vertical};
      expect_samples_of_the_file(style, random_jpeg(style, Blocks::kNoise, 90));
      for (const int quality : {3, 25, 60, 95}) {
        expect_samples_of_the_file(style, random_jpeg(style, Blocks::kMostlyFlat, quality));
      }
      JpegStyle unusual = style;
      unusual.own_huffman_tables = unusual.with_restarts = true;
      expect_samples_of_the_file(unusual, random_jpeg(unusual, Blocks::kMostlyFlat, 60));
    }
  }
}

TEST_F(MjpgDecoderTest, ColorsAndSamplesThatNoCameraSendsAreRefused) {
  begin();
  expect_damage(jpeg_of({.rgb = true}), "its colors are not YUV");
  expect_damage(jpeg_of({.horizontal = 3}), "its numbers of luma and chroma samples are unusual");
  expect_picture({}, jpeg_of());
}

TEST_F(MjpgDecoderTest, APictureWithoutHuffmanTablesUsesTheStandardOnes) {
  begin();
  expect_picture({}, jpeg_of({.own_huffman_tables = true}));
  expect_picture({}, jpeg_of({.with_huffman_tables = false}));
}

TEST_F(MjpgDecoderTest, MemorySufficesForTheLargestPicture) {
  const JpegStyle style{.width = kMaxFrameWidth, .height = 64, .horizontal = 1, .vertical = 1};
  begin(style);
  expect_picture(style, jpeg_of(style));
}

TEST_F(MjpgDecoderTest, DamageIsReportedAndTheNextPictureIsGood) {
  begin();
  const JpegStyle style;
  const std::vector<std::uint8_t> good = jpeg_of();
  std::vector<std::uint8_t> half(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2));
  expect_damage(half, kCutOff);
  expect_picture(style, good);
  std::vector<std::uint8_t> bad = good;
  for (std::size_t i = good.size() / 2; i < good.size() / 2 + 40; ++i) bad[i] = 0xff;  // markers in the middle
  EXPECT_EQ(decoder_.decode(bad, picture_.data()).code(), ErrorCode::kCorruptFrame);
  expect_picture(style, good);
  expect_damage({}, "Empty input file");
  expect_damage(std::vector<std::uint8_t>(1000, 0), "Not a JPEG file: starts with 0x00 0x00");
  expect_damage(jpeg_of({.width = 640, .height = 480}), "its size is 640x480");
  expect_damage(jpeg_of({.progressive = true}), "not a baseline JPEG with one scan");
  expect_picture(style, good);
}

TEST_F(MjpgDecoderTest, StrayBytesOfManyCamerasAreAccepted) {
  begin();
  std::vector<std::uint8_t> jpeg = jpeg_of();
  jpeg.insert(jpeg.end() - 2, {0x00, 0x12});  // before the last marker
  jpeg.insert(jpeg.end(), 1000, 0x00);        // and after it
  expect_picture({}, jpeg);
}

TEST_F(MjpgDecoderTest, AnotherVersionOfTheFileFormatIsAccepted) {
  begin();
  std::vector<std::uint8_t> jpeg = jpeg_of();
  ASSERT_EQ(jpeg[6], 'J');
  jpeg[11] = 2;  // the major version; only 1 exists
  expect_picture({}, jpeg);
}

TEST_F(MjpgDecoderTest, AMissingEndMarkerIsAcceptedUnlessMoreIsMissing) {
  for (const bool with_restarts : {false, true}) {
    const JpegStyle style{.width = 64, .height = 48, .horizontal = 2, .vertical = 2, .with_restarts = with_restarts};
    begin(style);
    std::vector<std::uint8_t> jpeg = jpeg_of(style);
    jpeg.pop_back();
    expect_picture(style, jpeg);
    jpeg.pop_back();
    expect_picture(style, jpeg);
    while (!jpeg.empty()) {
      jpeg.pop_back();
      ASSERT_EQ(decoder_.decode(jpeg, picture_.data()).code(), ErrorCode::kCorruptFrame) << jpeg.size() << " bytes";
    }
    // Zeros instead of the end can be decoded.
    jpeg = jpeg_of(style);
    std::fill(jpeg.end() - 100, jpeg.end(), std::uint8_t{0});
    jpeg.insert(jpeg.end(), 1000, 0x00);
    EXPECT_EQ(decoder_.decode(jpeg, picture_.data()).code(), ErrorCode::kCorruptFrame);
  }
}

// Damaged data must not cause accesses out of bounds (the sanitizers check that), and the next picture must be good.
TEST_F(MjpgDecoderTest, AnySingleWrongByteIsHandled) {
  const JpegStyle style{.width = 64, .height = 48, .horizontal = 2, .vertical = 2};
  begin(style);
  const std::vector<std::uint8_t> good = jpeg_of(style);
  int damaged = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const unsigned change : {0xffu, 0x10u}) {
      std::vector<std::uint8_t> bad = good;
      bad[i] = static_cast<std::uint8_t>(bad[i] ^ change);
      damaged += decoder_.decode(bad, picture_.data()).ok() ? 0 : 1;
    }
  }
  EXPECT_GT(damaged, 200);
  expect_picture(style, good);
}

class MjpgCameraTest : public V4l2RunningTest {
 protected:
  MjpgCameraTest() {
    device_.formats = {{V4L2_PIX_FMT_MJPEG, {{320, 240}}, false}};
    device_.jpeg = jpeg_of();
  }
  static hal::CameraSettings requested() {
    hal::CameraSettings requested = settings();
    requested.format = CameraFormat::kMjpg;
    requested.width_px = 320;
    requested.height_px = 240;
    return requested;
  }
};

TEST_F(MjpgCameraTest, FramesArePlanarYuvAndComeWithTheirJpeg) {
  for (const unsigned interface : {V4L2_CAP_VIDEO_CAPTURE + 0u, V4L2_CAP_VIDEO_CAPTURE_MPLANE + 0u}) {
    device_.capabilities = interface | V4L2_CAP_STREAMING;
    begin(requested());
    EXPECT_EQ(camera_->info().format, PixelFormat::kYuvj422p);
    Result<FrameLease> result = camera_->wait(soon());
    ASSERT_TRUE(result.ok()) << result.text();
    const Frame& frame = result.value().frame();
    EXPECT_EQ(frame.format, PixelFormat::kYuvj422p);
    const Channels red = pixel_at(frame, 100, 100);
    EXPECT_NEAR(red[0], 76, 2);
    EXPECT_NEAR(red[1], 85, 2);
    EXPECT_NEAR(red[2], 255, 2);
    EXPECT_EQ(result.value().dma_bufs(), hal::kNoDmaBufs) << "memory of the camera object";
    const std::span<const std::uint8_t> jpeg = result.value().jpeg();
    EXPECT_TRUE(std::equal(jpeg.begin(), jpeg.end(), device_.jpeg.begin(), device_.jpeg.end()));
    EXPECT_EQ(device_.queued(), 3u) << "the lease keeps the buffer with the JPEG";
    result = FrameLease();
    EXPECT_EQ(device_.queued(), 4u);
    EXPECT_EQ(device_.readable(), 0u);
  }
}

TEST_F(MjpgCameraTest, ADamagedPictureIsDroppedAndTheNextIsGood) {
  device_.frame_faults[1].bytes = static_cast<std::int64_t>(device_.jpeg.size() / 2);
  device_.frame_faults[2].bytes = 0;
  device_.frame_faults[3].wrong_at = 0;
  device_.frame_faults[4].damaged = true;
  begin(requested());
  expect_frame(*camera_, 0);
  expect_loss(*camera_, ErrorCode::kCorruptFrame, std::string("/dev/video0: frame 1 cannot be decoded: ") + kCutOff);
  expect_loss(*camera_, ErrorCode::kShortFrame, "/dev/video0: frame 2 has 0 bytes instead of 1");
  expect_loss(*camera_, ErrorCode::kCorruptFrame,
              "/dev/video0: frame 3 cannot be decoded: Not a JPEG file: starts with 0xaa 0xd8");
  expect_loss(*camera_, ErrorCode::kCorruptFrame, "/dev/video0: the driver marks frame 4 as damaged");
  for (std::uint32_t i = 5; i < 12; ++i) expect_frame(*camera_, i);
  EXPECT_EQ(camera_->counters().corrupt, 3u);
  EXPECT_EQ(camera_->counters().short_frames, 1u);
  EXPECT_EQ(camera_->counters().lost, 0u);
}

TEST_F(MjpgCameraTest, WaitTimesOutWhileAllPicturesAreLent) {
  begin(requested());
  std::vector<FrameLease> leases;
  for (std::uint32_t i = 0; i < 4; ++i) {
    Result<FrameLease> frame = camera_->wait(soon());
    ASSERT_TRUE(frame.ok());
    for (const FrameLease& other : leases) EXPECT_NE(other.frame().plane[0], frame.value().frame().plane[0]);
    leases.push_back(std::move(frame).value());
  }
  const Instant deadline = soon();
  expect_error(camera_->wait(deadline), ErrorCode::kTimeout,
               "/dev/video0: no frame can arrive: all 4 buffers are in use");
  EXPECT_GE(kernel_.now(), deadline);
  const std::uint8_t* const first = leases[0].frame().plane[0];
  leases.clear();
  const Result<FrameLease> next = camera_->wait(soon());
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(next.value().frame().plane[0], first) << "memory that is in the caches";
}

TEST_F(MjpgCameraTest, AllocatesNothingEvenForDamagedPictures) {
  if (!DriverAllocations::are_counted()) GTEST_SKIP() << "the sanitizer replaces the allocator";
  for (std::uint32_t i = 0; i < 100; i += 10) {
    device_.frame_faults[i + 1].bytes = static_cast<std::int64_t>(device_.jpeg.size() / 2);
    device_.frame_faults[i + 3].wrong_at = 0;
  }
  begin(requested());
  const DriverAllocations counter;
  int good = 0, corrupt = 0;
  for (int i = 0; i < 100; ++i) {
    const Result<FrameLease> frame = camera_->wait(soon());
    good += frame.ok() ? 1 : 0;
    corrupt += frame.code() == ErrorCode::kCorruptFrame ? 1 : 0;
  }
  const std::uint64_t allocations = counter.count();
  EXPECT_EQ(allocations, 0u);
  EXPECT_EQ(good, 80);
  EXPECT_EQ(corrupt, 20);
}

}  // namespace
}  // namespace touchline::testing
