#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/pixel_format.h"
#include "firmware/recording/step_tap.h"

// Pictures as messages of ROS 2 (encoding "cdr"), which Foxglove shows and rosbag2 plays:
// sensor_msgs/msg/CompressedImage for JPEG files as the camera sent them, sensor_msgs/msg/Image for all other pictures.
// Formats that have no name in sensor_msgs/image_encodings.hpp are written with ours; programs show nothing for them,
// replays read them.
namespace touchline::recording {

/// Name and definition of the messages of a kind; not for kNone.
std::string_view picture_schema_name(PictureKind kind);
std::string_view picture_schema(PictureKind kind);

/// Writes what precedes the picture's bytes in a message. Raw pictures have rows without padding, one plane after the
/// other.
void write_picture_head(const StepHeader& step, std::uint64_t time_ns, std::size_t bytes, std::string& out);
/// Returns the bytes of the picture in a message; nullopt: it is no such message.
std::optional<std::span<const std::byte>> picture_of(PictureKind kind, std::span<const std::byte> message);

/// A raw picture in a message.
struct RawPicture {
  PixelFormat format = PixelFormat::kRgb24;
  std::uint16_t width_px = 0, height_px = 0;
  std::span<const std::byte> bytes;  // rows without padding, one plane after the other
};
/// Returns the raw picture in a message; nullopt: it is no such message, or its bytes are not those of its size.
std::optional<RawPicture> raw_picture_of(std::span<const std::byte> message);
/// Returns the picture as a frame, whose planes are in its bytes.
Frame frame_of(const RawPicture& picture);

}  // namespace touchline::recording
