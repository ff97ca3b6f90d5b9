#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "firmware/console/messages.h"

// Messages of Foxglove's WebSocket protocol in JSON (docs/console-protocol.md).
namespace touchline::console {

/// A frame and the data that its messages share.
struct FoxgloveFrame {
  const Scene& scene;
  const Snapshot& snapshot;
  double captured_s = 0.0;  // Unix time
};

void write_foxglove_server_info(report::JsonWriter& json, const Scene& scene, std::string_view session);
/// Writes all channels with their schemas.
void write_foxglove_channels(report::JsonWriter& json);
void write_foxglove_error(report::JsonWriter& json, std::string_view text);

/// Writes foxglove.CompressedImage.
void write_foxglove_picture(report::JsonWriter& json, std::span<const std::byte> jpeg, double captured_s);
/// Writes foxglove.ImageAnnotations: outlines of the robots and the ball that were detected in this picture. `divisor`:
/// reduction of the picture's size.
void write_foxglove_annotations(report::JsonWriter& json, const FoxgloveFrame& frame, int divisor);
/// Writes foxglove.SceneUpdate: robots and ball on the field according to the tracks, and the field's lines if they are
/// wanted.
void write_foxglove_scene(report::JsonWriter& json, const FoxgloveFrame& frame, bool with_field);

}  // namespace touchline::console
