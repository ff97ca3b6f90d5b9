#include "tests/benchmark/mjpg_benchmark.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <vector>

#include "core/pipeline.h"
#include "firmware/config/configuration.h"
#include "hal/linux/v4l2/mjpg_decoder.h"
#include "hal/replay/picture.h"
#include "tests/benchmark/field_picture.h"
#include "tests/benchmark/step_benchmark.h"
#include "tests/linux/jpeg_encoder.h"
#include "tests/region/patterns.h"

namespace touchline::testing {
namespace {

using Jpeg = std::vector<std::uint8_t>;

constexpr int kQuality = 80;
// Webcams limit the size of a picture: most send 14 to 16 kB at 640 x 480.
constexpr std::size_t kCameraBytes = 15000;
constexpr std::array kSpaces{ColorSpace::kRgb, ColorSpace::kYuvFullRange};

struct Compression {
  std::string name;
  int rows;                   // number of pixels that share a chroma sample
  bool is_of_camera = false;  // compress to the size that cameras send, instead of with kQuality
};

Jpeg encode(const Frame& frame, int rows_of_chroma, int quality) {
  const auto set_up = [=](jpeg_compress_struct& jpeg) {
    jpeg_set_quality(&jpeg, quality, TRUE);
    jpeg.comp_info[0].h_samp_factor = 2;
    jpeg.comp_info[0].v_samp_factor = rows_of_chroma;
  };
  return encode_jpeg(frame.width_px, frame.height_px, set_up, [&frame](unsigned v, std::span<std::uint8_t> row) {
    std::copy_n(frame.plane[0] + std::size_t{v} * frame.stride_bytes[0], row.size(), row.begin());
  });
}

// Returns the best quality at which a picture has at most kCameraBytes, or kQuality.
int quality_of(const Compression& compression, const Frame& frame) {
  if (!compression.is_of_camera) return kQuality;
  int low = 1, high = 100;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    const bool fits = encode(frame, compression.rows, middle).size() <= kCameraBytes;
    if (fits) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/// Decodes JPEGs to planar YUV as the driver does, or to RGB.
class Decoder {
 public:
  Decoder(ColorSpace space, const Frame& like) {
    frame_.width_px = like.width_px;
    frame_.height_px = like.height_px;
    if (space == ColorSpace::kRgb) {
      frame_.stride_bytes[0] = 3u * like.width_px;
      bytes_.resize(std::size_t{frame_.stride_bytes[0]} * like.height_px);
      frame_.plane[0] = bytes_.data();
      jpeg_.err = jpeg_std_error(&errors_);
      jpeg_create_decompress(&jpeg_);
      return;
    }
    yuv_.open(like.width_px, like.height_px);
    frame_.format = PixelFormat::kYuvj422p;
    frame_.stride_bytes = yuv_.layout().stride_bytes;
    bytes_.resize(yuv_.layout().bytes);
    for (std::size_t i = 0; i < kMaxPlanes; ++i) frame_.plane[i] = bytes_.data() + yuv_.layout().offset_bytes[i];
  }
  ~Decoder() { jpeg_destroy_decompress(&jpeg_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  const Frame& decode(const Jpeg& bytes) {
    if (frame_.format == PixelFormat::kYuvj422p) {
      // Cannot fail, because the benchmark has made the picture itself.
      if (!yuv_.decode(bytes, bytes_.data()).ok()) std::abort();
      return frame_;
    }
    jpeg_mem_src(&jpeg_, bytes.data(), bytes.size());
    jpeg_read_header(&jpeg_, TRUE);
    jpeg_.out_color_space = JCS_RGB;
    jpeg_.dct_method = JDCT_ISLOW;
    jpeg_.do_fancy_upsampling = FALSE;
    jpeg_start_decompress(&jpeg_);
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = bytes_.data() + std::size_t{jpeg_.output_scanline} * frame_.stride_bytes[0];
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return frame_;
  }

 private:
  Frame frame_;
  std::vector<std::uint8_t> bytes_;
  hal::MjpgDecoder yuv_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
};

/// Returns the median of the pixels of each color, by the classification of `grid`; none for a color without pixels.
std::array<std::optional<Channels>, kMaxColors + 1> medians(const ColorGrid& grid, const Frame& frame) {
  std::array<std::array<std::vector<std::uint8_t>, 3>, kMaxColors + 1> values;
  for (int v = 0; v < frame.height_px; ++v) {
    for (int u = 0; u < frame.width_px; ++u) {
      const Channels pixel = channels_at(frame, u, v);
      for (std::size_t c = 0; c < 3; ++c) values[grid.at(u, v)][c].push_back(pixel[c]);
    }
  }
  std::array<std::optional<Channels>, kMaxColors + 1> found;
  for (std::size_t color = 0; color < found.size(); ++color) {
    if (values[color][0].empty()) continue;
    Channels median{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto middle = values[color][c].begin() + static_cast<std::ptrdiff_t>(values[color][c].size() / 2);
      std::nth_element(values[color][c].begin(), middle, values[color][c].end());
      median[c] = *middle;
    }
    found[color] = median;
  }
  return found;
}

/// Returns the same colors in the color space of another frame of the same picture.
ScanParameters in_space_of(const Frame& frame, const ColorGrid& grid, const ScanParameters& rgb) {
  ScanParameters parameters = rgb;
  const auto typical = medians(grid, frame);
  parameters.format = frame.format;
  parameters.background = typical[kBackground];
  if (color_space(frame.format) == ColorSpace::kRgb) return parameters;
  constexpr std::array<int, 3> kReach{32, 20, 20};  // strong compression moves the chroma of a patch's edge by 20
  parameters.boxes.clear();
  for (ColorId color = 1; color <= kMaxColors; ++color) {
    if (!typical[color]) continue;
    ColorBox box{color, {}, {}};
    for (std::size_t c = 0; c < 3; ++c) {
      box.low[c] = static_cast<std::uint8_t>(std::max((*typical[color])[c] - kReach[c], 0));
      box.high[c] = static_cast<std::uint8_t>(std::min((*typical[color])[c] + kReach[c], 255));
    }
    parameters.boxes.push_back(box);
  }
  return parameters;
}

std::unique_ptr<BenchmarkCase> empty_case(const std::string& name) {
  return std::make_unique<BenchmarkCase>(
      BenchmarkCase{.name = name, .picture = OwnedPicture(PixelFormat::kRgb24, 1, 1, 0), .parameters = {}});
}

std::string suffix(ColorSpace space) { return space == ColorSpace::kRgb ? ", RGB" : ", YUV"; }

/// Makes the methods: decoding alone, and decoding with the scan. `parameters(decoded)` makes the scan's parameters.
template <class Parameters>
Result<void> add_scans(BenchmarkCase& benchmark, const std::shared_ptr<Jpeg>& jpeg, const Frame& like,
                       Parameters parameters) {
  struct Scan {
    Runs runs;
    Regions regions;
  };
  const auto outputs = std::make_shared<Scan>();
  for (const ColorSpace space : kSpaces) {
    const auto decoder = std::make_shared<Decoder>(space, like);
    const auto scanner = std::make_shared<RegionScanner>();
    const ScanParameters wanted = parameters(decoder->decode(*jpeg));
    if (const Status s = scanner->configure(wanted); !s.ok()) return Error{s.code(), "the scanner refuses the boxes"};
    const auto scan = [decoder, scanner, outputs, jpeg] {
      static_cast<void>(scanner->scan(decoder->decode(*jpeg), outputs->runs, outputs->regions));
    };
    scan();
    const auto patches = std::count_if(outputs->regions.begin(), outputs->regions.end(),
                                       [](const Region& region) { return region.area_px >= 30; });
    benchmark.found += std::to_string(patches) + " regions as large as a patch" + suffix(space) + "; ";
    if (patches < 12) return failure(ErrorCode::kInconsistent, "only %s", benchmark.found.c_str());
    benchmark.methods.push_back({"decode" + suffix(space), [decoder, jpeg] { decoder->decode(*jpeg); }, {}});
    benchmark.methods.push_back({"regions" + suffix(space), scan, {}});
  }
  benchmark.found += std::to_string(jpeg->size()) + " bytes";
  return {};
}

Result<void> add_picture(BenchmarkCase& benchmark, const Compression& compression, const Frame& frame,
                         const ScanParameters& rgb) {
  const auto jpeg = std::make_shared<Jpeg>(encode(frame, compression.rows, quality_of(compression, frame)));
  const ColorGrid grid = defined_colors(frame, rgb);
  return add_scans(benchmark, jpeg, frame, [&](const Frame& decoded) { return in_space_of(decoded, grid, rgb); });
}

Result<void> add_field(BenchmarkCase& benchmark, const Compression& compression) {
  FieldScene scene;
  // Noise and hot pixels are left out, because cameras remove them before they compress. With them, a picture of a
  // camera's size would show no colors.
  if (compression.is_of_camera) {
    scene.noise = 1.0;
    scene.specks_per_megapixel = 0.0;
  }
  ScanParameters parameters = field_parameters(scene);
  parameters.min_area_px = 2;
  return add_picture(benchmark, compression, paint_field(scene).frame(), parameters);
}

Result<void> add_real_picture(BenchmarkCase& benchmark, const Compression& compression, const std::string& shared) {
  TOUCHLINE_TRY_ASSIGN(const hal::Picture picture, hal::read_picture(shared + "/footage/vsss-bar/normal_06.png"));
  Frame frame;
  frame.width_px = static_cast<std::uint16_t>(picture.width_px);
  frame.height_px = static_cast<std::uint16_t>(picture.height_px);
  frame.plane[0] = picture.rgb8.data();
  frame.stride_bytes[0] = 3 * picture.width_px;
  const auto venue = std::make_unique<config::Configuration>();
  const std::string footage = TOUCHLINE_FOOTAGE;
  TOUCHLINE_TRY(config::load_venue_and_team(
      {{}, footage + "/vsss-bar-normal-venue.toml", footage + "/vsss-bar-normal-team.toml", {}}, *venue));
  TOUCHLINE_TRY(config::resolve({PixelFormat::kRgb24, frame.width_px, frame.height_px, "a picture"}, *venue));
  return add_picture(benchmark, compression, frame, venue->pipeline.scan);
}

/// Measures the whole step on the pictures of a game, from JPEG to packet.
class JpegGame {
 public:
  Result<void> prepare(ColorSpace space, const StepBenchmark& game, const Compression& compression) {
    const std::string mock = TOUCHLINE_BOARDS "/mock";
    const bool is_rgb = space == ColorSpace::kRgb;
    TOUCHLINE_TRY(config::load({mock + "/board.toml",
                                is_rgb ? "" : mock + "/venue-mjpg.toml",
                                "",
                                {is_rgb ? "camera.format=rgb24" : "camera.format=mjpg"}},
                               *configuration_));
    if (const Status s = pipeline_->configure(configuration_->pipeline); !s.ok()) {
      return Error{s.code(), "the pipeline refuses its configuration"};
    }
    const int quality = quality_of(compression, game.frame(0));
    for (std::size_t i = 0; i < game.frames(); ++i) {
      stamps_.push_back(game.frame(i).capture_time);
      jpegs_.push_back(encode(game.frame(i), compression.rows, quality));
    }
    decoder_ = std::make_unique<Decoder>(space, game.frame(0));
    for (std::size_t i = 0; i < game.frames(); ++i) {
      if (step().sightings.robots.size() == configuration_->board.arena.robot.size()) continue;
      return Error{ErrorCode::kInconsistent, "a frame does not show all robots"};
    }
    return {};
  }
  [[nodiscard]] std::size_t mean_bytes() const {
    std::size_t sum = 0;
    for (const Jpeg& jpeg : jpegs_) sum += jpeg.size();
    return sum / jpegs_.size();
  }
  const StepTrace& step() {
    inputs_.events.reset = next_ == jpegs_.size();
    if (inputs_.events.reset) next_ = 0;
    Frame frame = decoder_->decode(jpegs_[next_]);
    frame.capture_time = stamps_[next_];
    frame.sequence = static_cast<std::uint32_t>(next_++);
    return pipeline_->step(frame, inputs_);
  }

 private:
  std::unique_ptr<config::Configuration> configuration_ = std::make_unique<config::Configuration>();
  std::unique_ptr<Pipeline> pipeline_ = std::make_unique<Pipeline>();
  StepInputs inputs_;
  std::unique_ptr<Decoder> decoder_;
  std::vector<Jpeg> jpegs_;
  std::vector<Instant> stamps_;
  std::size_t next_ = 0;
};

Result<void> add_steps(BenchmarkCase& benchmark, const Compression& compression) {
  StepBenchmark game;
  TOUCHLINE_TRY(game.prepare(mock_files()));
  for (const ColorSpace space : kSpaces) {
    const auto of_space = std::make_shared<JpegGame>();
    TOUCHLINE_TRY(of_space->prepare(space, game, compression));
    benchmark.found = "a game in pictures of " + std::to_string(of_space->mean_bytes()) + " bytes on average";
    benchmark.methods.push_back({"step" + suffix(space), [of_space] { static_cast<void>(of_space->step()); }, {}});
  }
  return {};
}

}  // namespace

std::vector<std::uint8_t> camera_jpeg(const Frame& frame) { return encode(frame, 2, quality_of({"", 2, true}, frame)); }

Result<void> add_mjpg_cases(BenchmarkCases& cases, const std::string& filter) {
  const auto add = [&](const std::string& name, const auto& fill) -> Result<void> {
    if (name.find(filter) == std::string::npos) return {};
    cases.push_back(empty_case(name));
    Result<void> filled = fill(*cases.back());
    if (!filled.ok()) return prefixed(name, std::move(filled).error());
    return {};
  };
  for (const Compression& compression : {Compression{"mjpg 4:2:0", 2}, Compression{"mjpg 4:2:2", 1},
                                         Compression{std::string("mjpg 4:2:0") + kCameraSize, 2, true},
                                         Compression{std::string("mjpg 4:2:2") + kCameraSize, 1, true}}) {
    const std::string& name = compression.name;
    TOUCHLINE_TRY(add(name + " field 640x480", [&](BenchmarkCase& c) { return add_field(c, compression); }));
    TOUCHLINE_TRY(add(name + " step", [&](BenchmarkCase& c) { return add_steps(c, compression); }));
    if (const char* const shared = std::getenv("TOUCHLINE_SHARED"); shared != nullptr) {
      TOUCHLINE_TRY(
          add(name + " vsss-bar", [&](BenchmarkCase& c) { return add_real_picture(c, compression, shared); }));
    }
  }
  return {};
}

}  // namespace touchline::testing
