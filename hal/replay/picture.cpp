#include "hal/replay/picture.h"

#include <cinttypes>

#include "hal/files/input_file.h"
#include "hal/replay/picture_decoder.h"

namespace touchline::hal {
namespace {

Result<StoredPicture> as_rgb(Result<Picture> picture) {
  if (!picture.ok()) return std::move(picture).error();
  return StoredPicture{std::move(picture).value(), false};
}

// Not inlined: gcc 12 would falsely warn that a short string may be uninitialized.
[[gnu::noinline]] Result<StoredPicture> decode(std::string_view bytes, std::int64_t max_pixels, JpegColors colors) {
  if (bytes.empty()) return failure(ErrorCode::kCorruptFrame, "the file is empty");
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return as_rgb(decode_png(bytes, max_pixels));
  if (bytes.starts_with("\xff\xd8\xff")) return decode_jpeg(bytes, max_pixels, colors);
  constexpr std::string_view kKindsOfPnm = "2356";
  if (bytes.size() > 2 && bytes[0] == 'P' && kKindsOfPnm.find(bytes[1]) != std::string_view::npos) {
    return as_rgb(decode_pnm(bytes, max_pixels));
  }
  return failure(ErrorCode::kUnsupported, "is not a PNG, PPM or JPEG picture");
}

}  // namespace

Error too_many_pixels(std::int64_t max_pixels) {
  return failure(ErrorCode::kOutOfRange, "the picture has more than %" PRId64 " pixels", max_pixels);
}

Error damaged(const char* cause) { return failure(ErrorCode::kCorruptFrame, "truncated or damaged (%s)", cause); }

Result<StoredPicture> decode_picture(const std::string& path, std::int64_t max_pixels, JpegColors colors) {
  TOUCHLINE_TRY_ASSIGN(const std::string bytes, read_file(path, kMaxDataFileBytes));
  Result<StoredPicture> decoded = decode(bytes, max_pixels, colors);
  if (!decoded.ok()) return prefixed(path, std::move(decoded).error());
  return decoded;
}

Result<Picture> read_picture(const std::string& path, std::int64_t max_pixels) {
  TOUCHLINE_TRY_ASSIGN(StoredPicture decoded, decode_picture(path, max_pixels, JpegColors::kRgb));
  return std::move(decoded.values);
}

Result<void> write_picture(const std::string& path, const Picture& picture, const OutputOptions& options) {
  Result<std::string> png = encode_png(picture);
  if (!png.ok()) return prefixed(path, std::move(png).error());
  return write_file(path, png.value(), options);
}

}  // namespace touchline::hal
