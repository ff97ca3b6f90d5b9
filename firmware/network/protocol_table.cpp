// The encoder of each output protocol and the decoder of each input protocol. A protocol's word and usual address are
// in firmware/config/network_settings.h.
#include <array>
#include <numbers>
#include <string>
#include <utility>

#include "firmware/network/arena_message.h"
#include "firmware/network/decoder.h"
#include "firmware/network/encoder.h"
#include "firmware/network/firasim.h"
#include "firmware/network/json_commands.h"
#include "firmware/network/json_line.h"
#include "firmware/network/publisher.h"
#include "firmware/network/referee.h"
#include "firmware/network/ssl_tracked.h"
#include "firmware/network/ssl_vision.h"
#include "firmware/network/vss_placement.h"

namespace touchline::network {
namespace {

// Encoder for all protocols: encode_frame() calls a function that holds copies of the data that it needs.
template <class Function>
class FunctionEncoder final : public Encoder {
 public:
  explicit FunctionEncoder(Function function) : function_(std::move(function)) {}
  std::size_t encode_frame(const OutputFrame& frame, std::span<std::byte> out) override {
    return function_(frame, out);
  }

 private:
  Function function_;
};

template <class Function>
std::unique_ptr<Encoder> encoder_of(Function function) {
  return std::make_unique<FunctionEncoder<Function>>(std::move(function));
}

class SslVisionOutput final : public Encoder {
 public:
  explicit SslVisionOutput(std::uint32_t camera_id) : camera_id_(camera_id) {}
  Status configure(const VenueGeometry& geometry) { return encoder_.configure(geometry); }
  std::size_t encode_frame(const OutputFrame& frame, std::span<std::byte> out) override {
    return encoder_.encode_detection(frame, out);
  }
  std::size_t encode_geometry(std::span<std::byte> out) override { return encoder_.encode_geometry(camera_id_, out); }

 private:
  const std::uint32_t camera_id_;
  SslVisionEncoder encoder_;
};

Result<std::unique_ptr<Encoder>> make_ssl_vision(const VenueGeometry& geometry, std::uint32_t camera_id) {
  auto output = std::make_unique<SslVisionOutput>(camera_id);
  if (const Status status = output->configure(geometry); !status.ok()) {
    return failure(status.code(), "SSL-Vision's camera model cannot describe this camera: %s", describe(status.code()));
  }
  return std::unique_ptr<Encoder>(std::move(output));
}

template <class Function>
class FunctionDecoder final : public Decoder {
 public:
  explicit FunctionDecoder(Function function) : function_(std::move(function)) {}
  Result<DecodedMessage> decode(std::span<const std::byte> message, TeamColor own) override {
    return function_(message, own);
  }

 private:
  Function function_;
};

template <class Function>
std::unique_ptr<Decoder> decoder_of(Function function) {
  return std::make_unique<FunctionDecoder<Function>>(std::move(function));
}

Result<DecodedMessage> of_commands(Result<CommandBatch> batch) {
  if (!batch.ok()) return std::move(batch).error();
  return DecodedMessage{std::move(batch).value(), std::nullopt, std::nullopt};
}

Result<DecodedMessage> of_request(Result<ArenaRequest> request) {
  if (!request.ok()) return std::move(request).error();
  return DecodedMessage{{}, std::nullopt, std::move(request).value()};
}

Result<DecodedMessage> of_referee(Result<RefereeMessage> message) {
  if (!message.ok()) return std::move(message).error();
  return DecodedMessage{{}, std::move(message).value(), std::nullopt};
}

/// Returns the names for each color that our team may have, indexed by TeamColor, because a referee may exchange the
/// colors.
std::array<report::TraceNames, 2> names_of(const config::Configuration& configuration) {
  report::TraceNames names;
  names.colors = {"background"};
  for (const config::ColorEntry& color : configuration.venue.color) names.colors.push_back(color.name);
  names.teams = {configuration.team.own.color, configuration.team.opponent.color};
  report::TraceNames exchanged = names;
  std::swap(exchanged.teams[0], exchanged.teams[1]);
  const TeamColor own = published_scene(configuration).own;
  std::array<report::TraceNames, 2> by_color;
  by_color[static_cast<std::size_t>(own)] = std::move(names);
  by_color[static_cast<std::size_t>(other(own))] = std::move(exchanged);
  return by_color;
}

std::string device_of(const hal::CameraSettings& camera) {
  return camera.backend == hal::CameraBackend::kMock ? "mock" : camera.device;
}

VenueGeometry geometry_of(const config::Configuration& configuration) {
  const MarkerParameters& marker = configuration.pipeline.marker;
  VenueGeometry geometry;
  geometry.field = marker.field;
  geometry.camera = configuration.pipeline.camera;
  if (configuration.pipeline.has_pictures) {
    geometry.width_px = configuration.board.camera.width_px;
    geometry.height_px = configuration.board.camera.height_px;
  }
  geometry.ball_radius_m = marker.ball.radius_m;
  for (std::size_t team = 0; team < 2; ++team) {
    geometry.robot_height_m[team] = marker.teams[team].layout.height_m;
  }
  return geometry;
}

Result<std::unique_ptr<Encoder>> make_vss_placement(const config::Configuration& configuration) {
  const FieldParameters& field = configuration.pipeline.marker.field;
  const PlayParameters& play = configuration.pipeline.control.play;
  PlacementSettings settings;
  settings.sizes.length_m = static_cast<double>(field.length_m);
  settings.sizes.width_m = static_cast<double>(field.width_m);
  settings.sizes.circle_radius_m = static_cast<double>(field.center_circle_m);
  settings.sizes.robot_radius_m = std::numbers::sqrt2 * play.robot_radius_m;
  settings.sizes.ball_radius_m = static_cast<double>(configuration.pipeline.marker.ball.radius_m);
  // Venue files without penalty areas keep the goal areas of the rules.
  if (field.penalty_area_depth_m > 0.0f && field.penalty_area_width_m > 0.0f) {
    settings.sizes.goal_area_depth_m = static_cast<double>(field.penalty_area_depth_m);
    settings.sizes.goal_area_width_m = static_cast<double>(field.penalty_area_width_m);
  }
  if (play.goalkeeper_id >= 0) settings.goalkeeper = static_cast<RobotId>(play.goalkeeper_id);
  settings.keeper_line_m = play.keeper_line_m;
  return encoder_of(
      [encoder = VssPlacementEncoder(settings)](const OutputFrame& frame, std::span<std::byte> out) mutable {
        return encoder.encode(frame, out);
      });
}

RefereeSettings referee_settings(const config::Configuration& configuration) {
  RefereeSettings settings;
  settings.own_team = configuration.board.network.own_team;
  for (const config::NamedTeam& team : configuration.board.network.team) {
    settings.heights.push_back({team.name, team.height_m});
  }
  return settings;
}

}  // namespace

Result<std::unique_ptr<Encoder>> make_encoder(config::OutputProtocol protocol,
                                              const config::Configuration& configuration) {
  switch (protocol) {
    case config::OutputProtocol::kSslVision:
      return make_ssl_vision(geometry_of(configuration), configuration.board.network.camera_id);
    case config::OutputProtocol::kSslTracked:
      return encoder_of([uuid = random_uuid()](const OutputFrame& frame, std::span<std::byte> out) {
        return encode_ssl_tracked(frame, uuid, out);
      });
    case config::OutputProtocol::kFirasim:
      return encoder_of(
          [field = configuration.pipeline.marker.field](const OutputFrame& frame, std::span<std::byte> out) {
            return encode_firasim_environment(frame, field, out);
          });
    case config::OutputProtocol::kJson:
      return encoder_of(
          [names = names_of(configuration), field = configuration.pipeline.marker.field,
           device = device_of(configuration.board.camera)](const OutputFrame& frame, std::span<std::byte> out) {
            return write_json_line(frame, names[static_cast<std::size_t>(frame.own)], field, device, out);
          });
    case config::OutputProtocol::kVsssPlacement:
      return make_vss_placement(configuration);
  }
  return failure(ErrorCode::kUnsupported, "no such protocol");
}

std::unique_ptr<Decoder> make_decoder(config::InputProtocol protocol, const config::Configuration& configuration) {
  switch (protocol) {
    case config::InputProtocol::kFirasim:
      return decoder_of(
          [radius_m = configuration.board.network.wheel_radius_m](std::span<const std::byte> message, TeamColor own) {
            return of_commands(decode_firasim_packet(message, own, radius_m));
          });
    case config::InputProtocol::kJson:
      return decoder_of([](std::span<const std::byte> message, TeamColor /*own*/) {
        const std::string_view text(reinterpret_cast<const char*>(message.data()), message.size());
        return is_arena_request(text) ? of_request(decode_arena_request(text))
                                      : of_commands(decode_json_commands(message));
      });
    case config::InputProtocol::kSslReferee:
      return decoder_of(
          [settings = referee_settings(configuration)](std::span<const std::byte> message, TeamColor own) {
            return of_referee(decode_ssl_referee(message, settings, own));
          });
    case config::InputProtocol::kVsssReferee:
      return decoder_of([](std::span<const std::byte> message, TeamColor own) {
        return of_referee(decode_vss_referee(message, own));
      });
  }
  return nullptr;
}

}  // namespace touchline::network
