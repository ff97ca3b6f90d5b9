#include <algorithm>

#include "firmware/console/hub.h"
#include "firmware/console/picture_scaler.h"

// Messages of the hub about single pictures, in addition to their JPEG: how they were understood.
namespace touchline::console {
namespace {

using namespace std::chrono_literals;

// Limit for an answer; a camera with 5 pictures a second needs less than half of it.
constexpr Duration kProbeTime = 2s;

}  // namespace

Result<void> Hub::accept_probe(Client& client, const ClientMessage& message, Instant now) {
  if (client.probes.size() >= kMaxWaitingProbes)
    return failure(ErrorCode::kBusy, "too many pixels are asked for at a time; wait for the answers");
  // Round to a pixel in the same way as write_probe().
  if (message.pixel.u_px >= static_cast<float>(scene_.camera.width_px) - 0.5f ||
      message.pixel.v_px >= static_cast<float>(scene_.camera.height_px) - 0.5f) {
    return failure(ErrorCode::kOutOfRange, "the pixel is outside the camera's picture");
  }
  client.probes.push_back({*message.request, message.pixel, next_picture_number(), now + kProbeTime});
  return {};
}

void Hub::expire_probes(Instant now) {
  for (Client& client : clients_) {
    while (!client.probes.empty() && client.probes.front().deadline < now && !has_probe_answer(client)) {
      client.answers.push_back({client.probes.front().request, "there is no picture that was examined"});
      client.probes.pop_front();
    }
  }
}

bool Hub::has_probe_answer(const Client& client) const {
  return !client.probes.empty() && pictures_.findings() != nullptr && pictures_.number() >= client.probes.front().from;
}

Outgoing Hub::probe_message(Client& client) {
  const Probe probe = client.probes.front();
  client.probes.pop_front();
  const Frame* const picture = pictures_.frame();
  const PictureFindings* const findings = pictures_.findings();
  if (picture == nullptr || findings == nullptr) return {};
  const Frame& frame = *picture;
  PixelPoint pixel = probe.pixel;  // limited, because another session's camera may be smaller
  pixel.u_px = std::min(pixel.u_px, static_cast<float>(frame.width_px - 1));
  pixel.v_px = std::min(pixel.v_px, static_cast<float>(frame.height_px - 1));
  return text_message(
      [&](auto& json) { write_probe(json, scene_, frame, *findings, pixel, pictures_.number(), probe.request); });
}

Outgoing Hub::findings_message(Client& client) {
  const Frame* const frame = pictures_.frame();
  const PictureFindings* const findings = pictures_.findings();
  if (frame == nullptr || findings == nullptr) return {};
  Outgoing out;
  if (std::exchange(client.findings_left.regions, false)) {
    out = text_message([&](auto& json) { write_regions(json, *findings, pictures_.number()); });
  } else if (std::exchange(client.findings_left.light, false)) {
    out = light_message(*frame, findings->classifier);
  } else if (std::exchange(client.findings_left.classes, false)) {
    out = classes_message(*frame, findings->classifier, client.link.level().divisor);
  }
  client.findings_bytes += out.bytes.size();
  return out;
}

Outgoing Hub::classes_message(const Frame& frame, const PixelClassifier& classifier, int divisor) {
  binary_.resize(kMessagePrefix + kPictureHeaderBytes);
  append_classes(frame, classifier, divisor, binary_);
  put_header(binary_.data() + kMessagePrefix, frame, kClassesKind, scaled(frame.width_px, divisor),
             scaled(frame.height_px, divisor), 0);
  return {std::span<std::byte>(binary_).subspan(kMessagePrefix), true};
}

Outgoing Hub::light_message(const Frame& frame, const PixelClassifier& classifier) {
  const bool is_one = classifier.tile_columns() == 0;
  const std::uint32_t tile_width = is_one ? frame.width_px : kTileWidth;
  const std::uint32_t tile_height = is_one ? frame.height_px : kTileHeight;
  binary_.resize(kMessagePrefix + kPictureHeaderBytes);
  append_light(classifier, binary_);
  put_header(binary_.data() + kMessagePrefix, frame, kLightKind, is_one ? std::uint16_t{1} : classifier.tile_columns(),
             is_one ? std::uint16_t{1} : classifier.tile_rows(), tile_width | tile_height << 16);
  return {std::span<std::byte>(binary_).subspan(kMessagePrefix), true};
}

}  // namespace touchline::console
