#include "firmware/console/foxglove_client.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace touchline::console {
namespace {

std::optional<std::uint32_t> number_of(const nlohmann::json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::uint64_t{UINT32_MAX}) return std::nullopt;
  return value.get<std::uint32_t>();
}

std::optional<std::uint32_t> member_of(const nlohmann::json& object, const char* name) {
  return object.is_object() && object.contains(name) ? number_of(object.at(name)) : std::nullopt;
}

}  // namespace

Result<void> FoxgloveClient::receive(std::string_view text) {
  const nlohmann::json message = nlohmann::json::parse(text, nullptr, false);
  if (!message.is_object()) return failure(ErrorCode::kCorruptFrame, "the message is not a JSON object");
  const std::string operation = message.value("op", nlohmann::json()).is_string() ? message.at("op") : "";
  const bool is_subscribe = operation == "subscribe";
  if (!is_subscribe && operation != "unsubscribe") {
    return failure(ErrorCode::kUnsupported, "\"%.32s\" is not possible: clients may only subscribe to channels",
                   operation.c_str());
  }
  const char* const name = is_subscribe ? "subscriptions" : "subscriptionIds";
  if (!message.contains(name) || !message.at(name).is_array()) {
    return failure(ErrorCode::kInconsistent, "\"%s\" must be a list", name);
  }
  for (const nlohmann::json& element : message.at(name)) {
    const std::optional<std::uint32_t> id = is_subscribe ? member_of(element, "id") : number_of(element);
    const std::optional<std::uint32_t> channel = is_subscribe ? member_of(element, "channelId") : 0;
    if (!id || !channel) return failure(ErrorCode::kInconsistent, "\"%s\" has an element without number", name);
    if (is_subscribe) {
      TOUCHLINE_TRY(subscribe(*id, *channel));
    } else {
      unsubscribe(*id);
    }
  }
  return {};
}

Result<void> FoxgloveClient::subscribe(std::uint32_t id, std::uint32_t channel) {
  if (channel < 1 || channel > kFoxgloveChannels) {
    return failure(ErrorCode::kNotFound, "there is no channel %u", channel);
  }
  std::optional<std::uint32_t>& subscription = subscriptions_[channel - 1U];
  if (subscription) return failure(ErrorCode::kInconsistent, "channel %u is subscribed to already", channel);
  if (std::find(subscriptions_.begin(), subscriptions_.end(), id) != subscriptions_.end()) {
    return failure(ErrorCode::kInconsistent, "subscription %u is in use", id);
  }
  subscription = id;
  if (channel - 1U == index_of(FoxgloveChannel::kScene)) wants_field = true;
  return {};
}

void FoxgloveClient::unsubscribe(std::uint32_t id) {
  for (std::size_t i = 0; i < kFoxgloveChannels; ++i) {
    if (subscriptions_[i] != id) continue;
    subscriptions_[i].reset();
    due[i] = false;
  }
}

}  // namespace touchline::console
