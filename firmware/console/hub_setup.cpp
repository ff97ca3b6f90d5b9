#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware/console/hub.h"

// The hub's part of the setup.
namespace touchline::console {

std::string setup_hello_text(const Scene& scene) {
  const config::Configuration& configuration = scene.configuration;
  const auto path = [](const config::Locations& where) {
    std::error_code unknown;
    const std::filesystem::path absolute = std::filesystem::absolute(where.file(), unknown);
    return unknown ? where.file() : absolute.lexically_normal().string();
  };
  const nlohmann::json hello{{"type", "hello"},
                             {"protocol", 1},
                             {"version", scene.version},
                             {"board", path(configuration.board_where)},
                             {"venue", path(configuration.venue_where)},
                             {"team", path(configuration.team_where)},
                             {"using", "saved"},
                             {"calibrated", true},
                             {"camera",
                              {{"width_px", scene.camera.width_px},
                               {"height_px", scene.camera.height_px},
                               {"rate_hz", scene.camera.rate_hz},
                               {"format", info_of(scene.camera.format).word}}}};
  return hello.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_setup_program(report::JsonWriter& json, bool is_running) {
  json.begin_object();
  json.key("type");
  json.string("setup_program");
  json.key("running");
  json.boolean(is_running);
  json.end_object();
}

void Hub::serve_setup(Instant now) {
  setup_.serve(now);
  if (!setup_.wants_frame(now)) return;
  const Snapshot* const snapshot = has_picture(setup_.next_frame()) ? feed_.find(pictures_.number()) : nullptr;
  if (snapshot == nullptr) return pictures_.request(now);
  setup_.send_frame(*pictures_.frame(), snapshot->number, captured_unix_s(*snapshot, unix_time_), now);
}

bool Hub::pass_to_setup(const Client& client, std::string_view text, const ClientMessage& message, Answer& answer) {
  answer.to = message.request.value_or(0);
  Result<void> passed = driving_.require_driver(client.number);
  if (passed.ok()) passed = setup_.pass_command(client, text, answer.to);
  if (!passed.ok()) answer.error = passed.text();
  return passed.ok();
}

Outgoing Hub::setup_message(Client& client) {
  if (std::exchange(client.wants_setup_program, false)) {
    return text_message([&](auto& json) { write_setup_program(json, setup_.is_running()); });
  }
  if (client.setup_state != nullptr) {
    parcel_ = std::exchange(client.setup_state, nullptr);
  } else if (!client.parcels.empty()) {
    parcel_ = std::move(client.parcels.front());
    client.parcels.pop_front();
  } else {
    return {};
  }
  return {std::span(parcel_->bytes).subspan(kMessagePrefix), parcel_->is_binary};
}

}  // namespace touchline::console
