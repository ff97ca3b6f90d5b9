#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

#include <jerror.h>

#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

/// libjpeg's object. Errors leave the library by longjmp(), so whatever has a destructor is outside of read().
class JpegFile {
 public:
  JpegFile() {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_.client_data = this;
    errors_.error_exit = fail;
    errors_.emit_message = [](j_common_ptr any, int level) {
      // Warnings mean damage, which libjpeg fills with gray. Another version of the header and surplus bytes before a
      // marker do not affect the picture.
      const int code = any->err->msg_code;
      if (level < 0 && code != JWRN_JFIF_MAJOR && code != JWRN_EXTRANEOUS_DATA) fail(any);
    };
  }
  ~JpegFile() { jpeg_destroy_decompress(&jpeg_); }
  JpegFile(const JpegFile&) = delete;
  JpegFile& operator=(const JpegFile&) = delete;

  [[nodiscard]] bool read(std::string_view bytes, std::int64_t max_pixels, JpegColors colors, StoredPicture& out);
  [[nodiscard]] bool is_too_large() const { return is_too_large_; }
  [[nodiscard]] bool is_unsupported() const { return is_unsupported_; }
  [[nodiscard]] const char* error_text() const { return error_text_.data(); }

 private:
  [[noreturn]] static void fail(j_common_ptr any) {
    auto& file = *static_cast<JpegFile*>(any->client_data);
    any->err->format_message(any, file.error_text_.data());
    std::longjmp(file.escape_, 1);  // NOLINT(cert-err52-cpp): through a library in C
  }

  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf escape_{};
  std::array<char, JMSG_LENGTH_MAX> error_text_{};
  bool is_too_large_ = false, is_unsupported_ = false;
};

bool JpegFile::read(std::string_view bytes, std::int64_t max_pixels, JpegColors colors, StoredPicture& out) {
  if (setjmp(escape_) != 0) return false;  // NOLINT(cert-err52-cpp)
  jpeg_create_decompress(&jpeg_);
  jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg_, TRUE);
  Picture& picture = out.values;
  picture.width_px = jpeg_.image_width;
  picture.height_px = jpeg_.image_height;
  is_too_large_ = std::int64_t{picture.width_px} * picture.height_px > max_pixels;
  is_unsupported_ = jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK;
  if (is_too_large_ || is_unsupported_) return false;
  out.is_yuv = colors == JpegColors::kAsStored && jpeg_.jpeg_color_space == JCS_YCbCr;
  jpeg_.out_color_space = out.is_yuv ? JCS_YCbCr : JCS_RGB;
  jpeg_.do_fancy_upsampling = out.is_yuv ? FALSE : TRUE;
  jpeg_start_decompress(&jpeg_);
  const std::size_t row_bytes = std::size_t{3} * picture.width_px;
  picture.rgb8.resize(row_bytes * picture.height_px);
  while (jpeg_.output_scanline < jpeg_.output_height) {
    JSAMPROW row = picture.rgb8.data() + jpeg_.output_scanline * row_bytes;
    jpeg_read_scanlines(&jpeg_, &row, 1);
  }
  jpeg_finish_decompress(&jpeg_);
  return true;
}

}  // namespace

Result<StoredPicture> decode_jpeg(std::string_view bytes, std::int64_t max_pixels, JpegColors colors) {
  JpegFile file;
  StoredPicture out;
  if (file.read(bytes, max_pixels, colors, out)) return out;
  if (file.is_too_large()) return too_many_pixels(max_pixels);
  if (file.is_unsupported()) {
    return failure(ErrorCode::kUnsupported, "a JPEG with the colors of a printer (CMYK); convert it to RGB");
  }
  return damaged(file.error_text());
}

}  // namespace touchline::hal
