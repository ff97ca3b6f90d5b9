#include "tools/programs/setup/camera_frame.h"

#include "tools/programs/setup/arguments.h"

namespace touchline::setup {

Result<CameraFrame> camera_frame_of(const Message& message) {
  const Arguments members(message.content);
  TOUCHLINE_TRY_ASSIGN(const std::string error, members.text("error", ""));
  if (!error.empty()) return Error{ErrorCode::kIo, error};
  TOUCHLINE_TRY_ASSIGN(const std::string word, members.text("format"));
  TOUCHLINE_TRY_ASSIGN(const double width_px, members.number("width_px", 16, kMaxFrameWidth));
  TOUCHLINE_TRY_ASSIGN(const double height_px, members.number("height_px", 16, kMaxFrameHeight));
  const std::optional<PixelFormat> format = calibrate::format_of(word);
  if (!format) return failure(ErrorCode::kInconsistent, "the format %.20s is unknown", word.c_str());
  Frame frame;
  frame.format = *format;
  frame.width_px = static_cast<std::uint16_t>(width_px);
  frame.height_px = static_cast<std::uint16_t>(height_px);
  const PictureLayout layout = picture_layout(frame.format, frame.width_px, frame.height_px);
  if (message.bytes.size() != layout.bytes) {
    return failure(ErrorCode::kInconsistent, "%u x %u pixels in %s have %zu bytes, not %zu", frame.width_px,
                   frame.height_px, word.c_str(), layout.bytes, message.bytes.size());
  }
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    frame.plane[plane] = reinterpret_cast<const std::uint8_t*>(message.bytes.data()) + layout.offset_bytes[plane];
    frame.stride_bytes[plane] = layout.stride_bytes[plane];
  }
  return std::make_shared<const calibrate::CameraPicture>(calibrate::CameraPicture::copy_of(frame));
}

}  // namespace touchline::setup
