#include "firmware/console/jpeg_encoder.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <vector>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

#include "firmware/console/picture_scaler.h"

namespace touchline::console {
namespace {

// Rows and columns of pixels in a block of chroma samples, each of which covers 2 x 2 pixels.
constexpr std::size_t kBlockRows = std::size_t{2} * DCTSIZE;

constexpr std::size_t padded(std::size_t samples, std::size_t multiple) {
  return (samples + multiple - 1) / multiple * multiple;
}

}  // namespace

/// libjpeg's object, with callbacks for output and errors. Errors leave the library by longjmp(), so functions between
/// setjmp() and the library have no objects with destructors.
struct JpegEncoder::Library {
  Library();
  ~Library() { jpeg_destroy_compress(&jpeg); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  bool compress(const PictureScaler& scaler, const Frame& frame, int divisor, int quality);
  void prepare(const PictureScaler& scaler, const Frame& frame, int quality);
  void write_rgb(const PictureScaler& scaler, const Frame& frame, int divisor);
  void write_yuv(const PictureScaler& scaler, const Frame& frame, int divisor);
  [[nodiscard]] static bool fits_directly(const Frame& frame, int divisor);

  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_destination_mgr destination{};
  std::jmp_buf escape{};
  std::array<char, JMSG_LENGTH_MAX> error_text{};
  std::span<std::byte> out;
  bool is_full = false;
  std::vector<std::uint8_t> rows;  // a row of RGB, or one row of blocks of Y, U and V
};

JpegEncoder::Library::Library() {
  jpeg.err = jpeg_std_error(&errors);
  jpeg.client_data = this;
  errors.error_exit = [](j_common_ptr common) {
    auto* const self = static_cast<Library*>(common->client_data);
    if (!self->is_full) common->err->format_message(common, self->error_text.data());
    std::longjmp(self->escape, 1);
  };
  errors.output_message = [](j_common_ptr) {};
  jpeg_create_compress(&jpeg);
  destination.init_destination = [](j_compress_ptr compress) {
    auto* const self = static_cast<Library*>(compress->client_data);
    self->destination.next_output_byte = reinterpret_cast<JOCTET*>(self->out.data());
    self->destination.free_in_buffer = self->out.size();
  };
  destination.empty_output_buffer = [](j_compress_ptr compress) -> boolean {
    auto* const self = static_cast<Library*>(compress->client_data);
    self->is_full = true;
    compress->err->error_exit(reinterpret_cast<j_common_ptr>(compress));
    return FALSE;
  };
  destination.term_destination = [](j_compress_ptr) {};
  jpeg.dest = &destination;
}

// Returns whether the planes use all values and their rows consist of whole blocks, so that the library can read them
// directly.
bool JpegEncoder::Library::fits_directly(const Frame& frame, int divisor) {
  const PixelFormatInfo& info = info_of(frame.format);
  return divisor == 1 && info.packing == Packing::kPlanar && info.space == ColorSpace::kYuvFullRange &&
         frame.width_px % kBlockRows == 0;
}

void JpegEncoder::Library::prepare(const PictureScaler& scaler, const Frame& frame, int quality) {
  const PixelFormatInfo& info = info_of(frame.format);
  jpeg.image_width = scaler.width_px();
  jpeg.image_height = scaler.height_px();
  jpeg.input_components = 3;
  jpeg.in_color_space = is_yuv(info.space) ? JCS_YCbCr : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.dct_method = JDCT_IFAST;  // the difference is invisible below a quality of 95
}

void JpegEncoder::Library::write_rgb(const PictureScaler& scaler, const Frame& frame, int divisor) {
  const bool is_direct = divisor == 1;
  if (is_direct) {
    const PixelFormatInfo& info = info_of(frame.format);
    const bool is_reversed = info.channel[0].offset == 2;
    const bool has_padding = info.channel[0].step == 4;
    jpeg.input_components = has_padding ? 4 : 3;
    jpeg.in_color_space =
        has_padding ? (is_reversed ? JCS_EXT_BGRX : JCS_EXT_RGBX) : (is_reversed ? JCS_EXT_BGR : JCS_EXT_RGB);
  }
  jpeg_start_compress(&jpeg, TRUE);
  for (std::size_t v = 0; v < jpeg.image_height; ++v) {
    JSAMPROW row = rows.data();
    if (is_direct) {
      // The library does not write to it.
      row = const_cast<std::uint8_t*>(frame.plane[0] + v * frame.stride_bytes[0]);
    } else {
      scaler.rgb_row(v, {rows.data(), std::size_t{3} * jpeg.image_width});
    }
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
}

void JpegEncoder::Library::write_yuv(const PictureScaler& scaler, const Frame& frame, int divisor) {
  const bool is_direct = fits_directly(frame, divisor);
  const std::size_t chroma_shift = is_direct ? info_of(frame.format).channel[1].shift_v : 1;
  jpeg.raw_data_in = TRUE;
  jpeg.comp_info[0].h_samp_factor = 2;
  jpeg.comp_info[0].v_samp_factor = 1 << chroma_shift;
  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t height = jpeg.image_height;
  const std::size_t luma_rows = std::size_t{DCTSIZE} << chroma_shift;
  const std::size_t luma_bytes = padded(jpeg.image_width, kBlockRows), chroma_bytes = luma_bytes / 2;
  const std::size_t chroma_height = (height + (std::size_t{1} << chroma_shift) - 1) >> chroma_shift;
  std::array<std::array<JSAMPROW, kBlockRows>, 3> pointers{};
  std::array<JSAMPARRAY, 3> planes{pointers[0].data(), pointers[1].data(), pointers[2].data()};
  for (std::size_t top = 0; top < height; top += luma_rows) {
    for (std::size_t c = 0; c < 3; ++c) {
      const bool is_luma = c == 0;
      const std::size_t count = is_luma ? luma_rows : std::size_t{DCTSIZE};
      const std::size_t first = is_luma ? top : top >> chroma_shift;
      const std::size_t last = (is_luma ? height : chroma_height) - 1;
      std::uint8_t* own = rows.data() + (is_luma ? 0 : kBlockRows * luma_bytes + (c - 1) * DCTSIZE * chroma_bytes);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t v = std::min(first + i, last);
        if (is_direct) {
          pointers[c][i] = const_cast<std::uint8_t*>(frame.plane[c] + v * frame.stride_bytes[c]);
          continue;
        }
        pointers[c][i] = own;
        if (is_luma) scaler.luma_row(v, {own, luma_bytes});
        if (!is_luma) scaler.chroma_row(v, c, {own, chroma_bytes});
        own += is_luma ? luma_bytes : chroma_bytes;
      }
    }
    jpeg_write_raw_data(&jpeg, planes.data(), static_cast<JDIMENSION>(luma_rows));
  }
}

bool JpegEncoder::Library::compress(const PictureScaler& scaler, const Frame& frame, int divisor, int quality) {
  // NOLINTNEXTLINE(cert-err52-cpp): the library knows no other way
  if (setjmp(escape) != 0) {
    jpeg_abort_compress(&jpeg);
    return false;
  }
  prepare(scaler, frame, quality);
  if (is_yuv(color_space(frame.format))) {
    write_yuv(scaler, frame, divisor);
  } else {
    write_rgb(scaler, frame, divisor);
  }
  jpeg_finish_compress(&jpeg);
  return true;
}

JpegEncoder::JpegEncoder() : library_(std::make_unique<Library>()) {}
JpegEncoder::~JpegEncoder() = default;

Result<std::size_t> JpegEncoder::encode(const Frame& frame, int divisor, int quality, std::span<std::byte> out) {
  const PictureScaler scaler(frame, divisor);
  if (scaler.width_px() == 0 || scaler.height_px() == 0) return failure(ErrorCode::kOutOfRange, "the picture is empty");
  library_->rows.resize(3 * kBlockRows * padded(scaler.width_px(), kBlockRows));
  library_->out = out;
  library_->is_full = false;
  if (library_->compress(scaler, frame, divisor, quality)) return out.size() - library_->destination.free_in_buffer;
  if (library_->is_full) return failure(ErrorCode::kFull, "the JPEG has more than %zu bytes", out.size());
  return failure(ErrorCode::kIo, "libjpeg: %s", library_->error_text.data());
}

}  // namespace touchline::console
