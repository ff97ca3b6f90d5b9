#include "firmware/console/setup_relay.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "firmware/console/picture_source.h"
#include "firmware/console/tested_robot.h"

namespace touchline::console {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

// Shortest period between two pictures for the setup program. A copy takes memory and time of the console's thread,
// though not of the loop, and a person needs no more pictures.
constexpr Duration kFramePeriod = 200ms;
constexpr int kMaxFrames = 100;
// Maximum number of commands without an answer. A page sends a command only after the answer to the previous one.
constexpr std::size_t kMaxRequests = 64;
// Kinds of binary messages with pictures and files for the page (docs/console-protocol.md).
constexpr std::uint8_t kSetupPicture = 2, kSetupFile = 3;

constexpr const char* kNotRunning = "the setup program is not running: systemctl start touchline-setup";

std::shared_ptr<Parcel> parcel_of(std::span<const std::byte> bytes, bool is_binary) {
  auto parcel = std::make_shared<Parcel>();
  parcel->bytes.resize(kMessagePrefix);
  parcel->bytes.insert(parcel->bytes.end(), bytes.begin(), bytes.end());
  parcel->is_binary = is_binary;
  return parcel;
}

std::shared_ptr<Parcel> parcel_of(std::string_view text) { return parcel_of(std::as_bytes(std::span(text)), false); }

// A client that is too slow misses the oldest pictures.
void put(Client& client, const std::shared_ptr<Parcel>& parcel) {
  client.parcels.push_back(parcel);
  if (client.parcels.size() <= kMaxWaitingParcels) return;
  const auto oldest = std::find_if(client.parcels.begin(), client.parcels.end(),
                                   [](const std::shared_ptr<Parcel>& waiting) { return !waiting->is_answer; });
  if (oldest != client.parcels.end()) client.parcels.erase(oldest);
}

// Returns 0 if there is no such member, or it is no number in range.
std::int64_t integer_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number_unsigned()) return 0;
  constexpr std::uint64_t kMax = std::uint64_t{1} << 53;
  const auto value = found->get<std::uint64_t>();
  return value <= kMax ? static_cast<std::int64_t>(value) : 0;
}

// Returns 0 if there is no such number.
float speed_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<float>() : 0.0f;
}

std::string text_of(const Json& object) { return object.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

SetupRelay::SetupRelay(std::string socket, std::list<Client>& clients, network::Print print, FileThread& files)
    : link_(std::move(socket), files), clients_(clients), print_(std::move(print)) {}

void SetupRelay::set_hello(std::string text) {
  hello_ = std::move(text);
  if (link_.is_connected()) link_.send(hello_);
}

void SetupRelay::serve(Instant now) {
  Result<void> served = link_.serve(now);
  if (link_.is_connected() && begun_ != link_.connections()) begin();
  while (served.ok()) {
    std::optional<SetupMessage> message = link_.receive();
    if (!message) break;
    served = obey(std::move(*message));
    if (!served.ok()) link_.close(now);
  }
  if (!served.ok()) end(served.error());
  if (std::exchange(was_running_, is_running()) != is_running()) announce();
}

void SetupRelay::begin() {
  begun_ = link_.connections();
  link_.send(hello_);
  tell_driver(driver_);
}

void SetupRelay::end(const Error& error) {
  const std::string text = "console: the setup program is lost: " + error.text.str();
  if (std::exchange(reported_, text) != text) print_(text);
  state_.reset();
  frames_wanted_ = 0;
  orders_.clear();
  wheels_.reset();
  for (const Request& request : std::exchange(requests_, {})) {
    Client* const client = find(request.client);
    if (client != nullptr) client->answers.push_back({request.number, error.text.str() + "; " + kNotRunning});
  }
}

void SetupRelay::announce() {
  if (is_running()) {
    reported_.clear();
    print_("console: the setup program is there");
  }
  for (Client& client : clients_) {
    client.wants_setup_program = true;
    if (!is_running()) client.setup_state.reset();
  }
}

Result<void> SetupRelay::pass_command(const Client& client, std::string_view text, std::int64_t request) {
  if (!is_running()) return failure(ErrorCode::kDisconnected, "%s", kNotRunning);
  if (requests_.size() >= kMaxRequests) return failure(ErrorCode::kBusy, "the setup program has not answered yet");
  Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return failure(ErrorCode::kCorruptFrame, "the message is not a JSON object");
  // Overwrite a number that a page may have sent, because only the server knows which client it is.
  message["client"] = client.number;
  if (!link_.send(text_of(message))) return failure(ErrorCode::kBusy, "the setup program does not read its messages");
  if (request != 0) requests_.push_back({client.number, request});
  return {};
}

void SetupRelay::watch(Client& client, bool watches) {
  if (std::exchange(client.watches_setup, watches) == watches) return;
  client.parcels.clear();
  client.setup_state = watches ? state_ : nullptr;
  if (watches && is_running()) link_.send(text_of({{"type", "watch"}, {"client", client.number}}));
}

void SetupRelay::tell_driver(std::optional<ClientNumber> driver) {
  driver_ = driver;
  if (link_.is_connected()) link_.send(text_of({{"type", "driver"}, {"client", driver ? Json(*driver) : Json()}}));
}

bool SetupRelay::send_step(const Snapshot& snapshot, RobotId robot) {
  return link_.send(text_of(tested_robot_json(snapshot, robot)));
}

void SetupRelay::forget(ClientNumber client) {
  std::erase_if(requests_, [client](const Request& request) { return request.client == client; });
}

bool SetupRelay::is_busy() const {
  const bool is_watched =
      std::any_of(clients_.begin(), clients_.end(), [](const Client& client) { return client.watches_setup; });
  return link_.is_connected() && (is_watched || link_.is_sending() || frames_wanted_ > 0 || !requests_.empty());
}

bool SetupRelay::wants_frame(Instant now) const {
  return frames_wanted_ > 0 && !link_.is_sending() && now >= next_frame_time_;
}

void SetupRelay::send_frame(const Frame& frame, std::uint64_t number, double captured_unix_s, Instant now) {
  const PictureLayout layout = picture_layout(frame.format, frame.width_px, frame.height_px);
  Json planes = Json::array();
  for (std::size_t plane = 0; plane < info_of(frame.format).planes; ++plane) {
    planes.push_back({{"offset", layout.offset_bytes[plane]},
                      {"stride_bytes", layout.stride_bytes[plane]},
                      {"rows", plane_rows(frame.format, plane, frame.height_px)}});
  }
  const Json text{{"type", "frame"},
                  {"number", number},
                  {"captured_s", captured_unix_s},
                  {"width_px", frame.width_px},
                  {"height_px", frame.height_px},
                  {"format", info_of(frame.format).word},
                  {"planes", std::move(planes)}};
  if (!link_.send(text_of(text), std::as_bytes(std::span(frame.plane[0], layout.bytes)))) return;
  --frames_wanted_;
  next_frame_ = number + 1;
  next_frame_time_ = now + kFramePeriod;
}

Client* SetupRelay::find(ClientNumber number) {
  const auto found =
      std::find_if(clients_.begin(), clients_.end(), [&](const Client& client) { return client.number == number; });
  return found == clients_.end() ? nullptr : &*found;
}

Result<void> SetupRelay::obey(SetupMessage&& message) {
  const Json object = Json::parse(message.text, nullptr, false);
  const auto type = object.is_object() ? object.find("type") : object.end();
  if (type == object.end() || !type->is_string()) {
    return failure(ErrorCode::kCorruptFrame, "its message is not a JSON object with a type");
  }
  const auto client = static_cast<ClientNumber>(integer_of(object, "client"));
  if (*type == "binary") return pass_binary(std::move(message.binary), client);
  if (*type == "answer") {
    pass_answer(std::move(message), client, integer_of(object, "to"));
    return {};
  }
  if (*type == "frames") {
    frames_wanted_ = static_cast<int>(std::min<std::int64_t>(integer_of(object, "count"), kMaxFrames));
    return {};
  }
  if (*type == "use" || *type == "try" || *type == "test") return take_order(object);
  if (*type == "wheels") {
    wheels_ = WheelSpeeds{speed_of(object, "left_mps"), speed_of(object, "right_mps")};
    return {};
  }
  const auto parcel = parcel_of(message.text);
  const bool is_state = *type == "setup";
  if (is_state) state_ = parcel;
  for (Client& watcher : clients_) {
    if (!watcher.watches_setup) continue;
    if (is_state) {
      watcher.setup_state = parcel;
    } else {
      put(watcher, parcel);
    }
  }
  return {};
}

Result<void> SetupRelay::take_order(const Json& object) {
  const auto text = [&object](const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  SetupOrder order;
  order.request = integer_of(object, "request");
  if (text("type") == "test") {
    const auto robot = object.find("robot");
    const bool has_robot = robot != object.end() && robot->is_number_unsigned() && robot->get<std::uint64_t>() <= 127;
    order.kind = has_robot ? SetupOrder::Kind::kTest : SetupOrder::Kind::kEndTest;
    if (has_robot) order.robot = robot->get<RobotId>();
    wheels_.reset();
  } else if (text("type") == "try") {
    const auto on = object.find("on");
    const bool begins = on != object.end() && on->is_boolean() && on->get<bool>();
    order.kind = begins ? SetupOrder::Kind::kTry : SetupOrder::Kind::kEndTry;
  } else if (text("source") == "draft") {
    order.kind = SetupOrder::Kind::kUseDraft;
    order.files.board = text("board");
    order.files.venue = text("venue");
    order.files.team = text("team");
  } else if (text("source") != "saved") {
    return failure(ErrorCode::kOutOfRange, "its \"source\" is neither \"draft\" nor \"saved\"");
  }
  orders_.push_back(std::move(order));
  return {};
}

std::optional<SetupOrder> SetupRelay::next_order() {
  if (orders_.empty()) return std::nullopt;
  SetupOrder order = std::move(orders_.front());
  orders_.pop_front();
  return order;
}

void SetupRelay::answer(const SetupOrder& order, const std::string& error, bool is_calibrated) {
  const bool is_use = order.kind == SetupOrder::Kind::kUseDraft || order.kind == SetupOrder::Kind::kUseSaved;
  const bool is_test = order.kind == SetupOrder::Kind::kTest || order.kind == SetupOrder::Kind::kEndTest;
  const char* const type = is_use ? "used" : is_test ? "tested" : "tried";
  Json text{{"type", type}, {"to", order.request}, {"ok", error.empty()}};
  if (is_use) text["calibrated"] = is_calibrated;
  if (!error.empty()) text["error"] = error;
  link_.send(text_of(text));
}

void SetupRelay::pass_answer(SetupMessage&& message, ClientNumber to, std::int64_t request) {
  const auto answered =
      std::erase_if(requests_, [&](const Request& other) { return other.client == to && other.number == request; });
  Client* const client = find(to);
  if (client == nullptr) return;
  const auto parcel = parcel_of(message.text);
  parcel->is_answer = answered > 0;  // an answer must not be dropped; at most kMaxRequests of them wait
  put(*client, parcel);
}

Result<void> SetupRelay::pass_binary(std::vector<std::byte> binary, ClientNumber only) {
  std::uint32_t magic = 0;
  if (binary.size() >= kPictureHeaderBytes) {
    for (std::size_t i = 0; i < sizeof(magic); ++i) magic |= std::to_integer<std::uint32_t>(binary[i]) << (8 * i);
  }
  const bool is_known = magic == kPictureMagic && std::to_integer<std::uint8_t>(binary[4]) == 1;
  const std::uint8_t kind = is_known ? std::to_integer<std::uint8_t>(binary[5]) : 0;
  if (kind != kSetupPicture && kind != kSetupFile) {
    return failure(ErrorCode::kCorruptFrame, "its binary message has a wrong header");
  }
  const auto parcel = parcel_of(binary, true);
  for (Client& client : clients_) {
    if (only != 0 ? client.number == only : client.watches_setup) put(client, parcel);
  }
  return {};
}

}  // namespace touchline::console
