#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "firmware/console/messages.h"

// Messages of Foxglove's WebSocket protocol in JSON (docs/console-protocol.md).
namespace touchline::console {

/// A frame and what its messages have in common.
struct FoxgloveFrame {
  const Scene& scene;
  const Snapshot& snapshot;
  double captured_s = 0.0;  // Unix time
};

void write_foxglove_server_info(report::JsonWriter& json, const Scene& scene, std::string_view session);
/// All channels with their schemas.
void write_foxglove_channels(report::JsonWriter& json);
void write_foxglove_error(report::JsonWriter& json, std::string_view text);

/// foxglove.CompressedImage.
void write_foxglove_picture(report::JsonWriter& json, std::span<const std::byte> jpeg, double captured_s);
/// foxglove.ImageAnnotations: outlines of the robots and the ball that were seen in this picture. `divisor`: of the
/// picture's size.
void write_foxglove_annotations(report::JsonWriter& json, const FoxgloveFrame& frame, int divisor);
/// foxglove.SceneUpdate: robots and ball on the field as the tracks have them, and its lines if they are wanted.
void write_foxglove_scene(report::JsonWriter& json, const FoxgloveFrame& frame, bool with_field);

}  // namespace touchline::console
