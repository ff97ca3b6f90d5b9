#include <algorithm>

#include "firmware/console/foxglove_messages.h"
#include "firmware/console/hub.h"

// Functions of the hub for Foxglove's protocol. Frames, pictures and limits are the same as for the page.
namespace touchline::console {
namespace {

// Header of a message: opcode, number of the subscription, and time in nanoseconds, little-endian.
constexpr std::size_t kDataHeaderBytes = 13;
constexpr std::uint8_t kDataOpcode = 1;
constexpr double kFoxgloveStateHz = 15.0;

}  // namespace

bool Hub::receive_foxglove(Client& client, std::string_view text, Instant now) {
  FoxgloveClient& foxglove = *client.foxglove;
  const Result<void> received = foxglove.receive(text);
  if (!received.ok() && foxglove.errors.size() < kMaxFoxgloveErrors) foxglove.errors.push_back(received.text());
  const bool has_state = foxglove.has(FoxgloveChannel::kState) || foxglove.has(FoxgloveChannel::kScene) ||
                         foxglove.has(FoxgloveChannel::kAnnotations);
  const bool has_picture = foxglove.has(FoxgloveChannel::kPicture);
  client.state_period = has_state ? from_seconds(1.0 / kFoxgloveStateHz) : Duration::zero();
  const Duration picture_period = has_picture ? picture_period_ : Duration::zero();
  if (picture_period != client.picture_period) client.link.set(1, picture_period);
  client.picture_period = picture_period;
  client.next_state = client.next_picture = now;
  return true;
}

bool Hub::has_foxglove_picture(const Client& client, Instant now) const {
  return is_picture_due(client, now) && pictures_.frame() != nullptr && pictures_.number() >= client.pictures_until &&
         feed_.find(pictures_.number()) != nullptr;
}

bool Hub::has_foxglove_message(const Client& client, Instant now) const {
  const FoxgloveClient& foxglove = *client.foxglove;
  const auto is_due = [](bool due) { return due; };
  return foxglove.wants_server_info || foxglove.wants_channels || !foxglove.errors.empty() ||
         std::any_of(foxglove.due.begin(), foxglove.due.end(), is_due) || has_foxglove_picture(client, now) ||
         is_state_due(client, now);
}

// Chooses the next frame and its messages.
void Hub::begin_foxglove_frame(Client& client, Instant now) {
  FoxgloveClient& foxglove = *client.foxglove;
  const auto add = [&](FoxgloveChannel channel) { foxglove.due[index_of(channel)] = foxglove.has(channel); };
  const bool is_picture = has_foxglove_picture(client, now);
  const Snapshot* const newest = feed_.newest();
  if (newest == nullptr || (!is_picture && !is_state_due(client, now))) return;
  foxglove.frame = is_picture ? pictures_.number() : newest->number;
  foxglove.level = client.link.level();
  if (is_picture) {
    add(FoxgloveChannel::kPicture);
    // Annotations belong to the picture, so they are sent with it.
    add(FoxgloveChannel::kAnnotations);
    advance(client.next_picture, client.picture_period, now);
    client.pictures_until = foxglove.frame + 1;
  } else if (!foxglove.has(FoxgloveChannel::kPicture)) {
    add(FoxgloveChannel::kAnnotations);
  }
  if (!is_state_due(client, now) || foxglove.frame < client.states_until) return;
  add(FoxgloveChannel::kState);
  add(FoxgloveChannel::kScene);
  advance(client.next_state, client.state_period, now);
  client.states_until = foxglove.frame + 1;
}

Outgoing Hub::next_foxglove_message(Client& client, Instant now) {
  FoxgloveClient& foxglove = *client.foxglove;
  if (std::exchange(foxglove.wants_server_info, false)) {
    return text_message([&](auto& json) { write_foxglove_server_info(json, scene_, session_name_); });
  }
  if (std::exchange(foxglove.wants_channels, false)) {
    return text_message([&](auto& json) { write_foxglove_channels(json); });
  }
  if (!foxglove.errors.empty()) {
    const std::string error = std::move(foxglove.errors.front());
    foxglove.errors.pop_front();
    return text_message([&](auto& json) { write_foxglove_error(json, error); });
  }
  const auto find_due = [&] { return std::find(foxglove.due.begin(), foxglove.due.end(), true); };
  if (find_due() == foxglove.due.end()) begin_foxglove_frame(client, now);
  const auto due = find_due();
  if (due == foxglove.due.end()) return {};
  *due = false;
  const Snapshot* const snapshot = feed_.find(foxglove.frame);
  if (snapshot == nullptr) {  // the client is so slow that its frame is no longer kept
    foxglove.due = {};
    return {};
  }
  return foxglove_data(client, static_cast<FoxgloveChannel>(due - foxglove.due.begin()), *snapshot, now);
}

Outgoing Hub::foxglove_data(Client& client, FoxgloveChannel channel, const Snapshot& snapshot, Instant now) {
  FoxgloveClient& foxglove = *client.foxglove;
  const FoxgloveFrame frame{scene_, snapshot, captured_unix_s(snapshot, unix_time_)};
  switch (channel) {
    case FoxgloveChannel::kState:
      return data_message(client, channel, frame,
                          [&](auto& json) { write_state(json, scene_, snapshot, driving_.input(), unix_time_); });
    case FoxgloveChannel::kScene: {
      const bool with_field = std::exchange(foxglove.wants_field, false);
      return data_message(client, channel, frame, [&](auto& json) { write_foxglove_scene(json, frame, with_field); });
    }
    case FoxgloveChannel::kAnnotations: {
      const int divisor = foxglove.has(FoxgloveChannel::kPicture) ? foxglove.level.divisor : 1;
      return data_message(client, channel, frame,
                          [&](auto& json) { write_foxglove_annotations(json, frame, divisor); });
    }
    case FoxgloveChannel::kPicture:
      break;
  }
  if (pictures_.frame() == nullptr || pictures_.number() != foxglove.frame) return {};
  const std::span<std::byte> jpeg = pictures_.jpeg(foxglove.level);
  if (jpeg.empty()) return {};
  const Outgoing message =
      data_message(client, channel, frame, [&](auto& json) { write_foxglove_picture(json, jpeg, frame.captured_s); });
  client.link.sent(foxglove.frame, message.bytes.size(), client.written + message.bytes.size(), now);
  // These clients never acknowledge a picture, so count it as seen; is_picture_due() uses what the kernel knows about
  // the connection.
  client.link.seen(foxglove.frame);
  return message;
}

template <class Write>
Outgoing Hub::data_message(const Client& client, FoxgloveChannel channel, const FoxgloveFrame& frame,
                           const Write& write) {
  const Outgoing message = text_message(write, kDataHeaderBytes);
  std::byte* to = message.bytes.data();
  put_little_endian(to, kDataOpcode);
  put_little_endian(to, client.foxglove->subscription(channel));
  put_little_endian(to, static_cast<std::uint64_t>(frame.captured_s * 1e9));
  return {message.bytes, true};
}

}  // namespace touchline::console
