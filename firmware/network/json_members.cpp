#include "firmware/network/json_members.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace touchline::network {
namespace {

using Json = nlohmann::json;

// The messages have at most five levels. A deeper one could exhaust the stack when it is destroyed.
constexpr int kMaxJsonDepth = 16;
// Characters of a value that a message shows.
constexpr std::size_t kShownCharacters = 40;

const Json& empty_object() {
  static const Json empty = Json::object();
  return empty;
}

}  // namespace

std::string shown_json(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kShownCharacters) text = text.substr(0, kShownCharacters) + "...";
  return text;
}

std::string shown_name(std::string_view name) {
  std::string out(name.substr(0, kShownCharacters));
  for (char& c : out) {
    if (c < ' ' || c > '~') c = '?';
  }
  return out;
}

Result<Json> parse_json_object(std::string_view text) {
  bool is_too_deep = false;
  const auto check_depth = [&](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
    is_too_deep = is_too_deep || depth > kMaxJsonDepth;
    return !is_too_deep;
  };
  Json object = Json::parse(text.begin(), text.end(), check_depth, false);
  if (is_too_deep) return failure(ErrorCode::kOutOfRange, "the message is nested more than %d times", kMaxJsonDepth);
  if (!object.is_object()) return failure(ErrorCode::kCorruptFrame, "the message is not a JSON object");
  return object;
}

JsonMembers::JsonMembers(const Json& object, std::string place, std::optional<Error>& error)
    : object_(&object), place_(std::move(place)), error_(&error) {
  if (object.is_object()) return;
  fail(failure(ErrorCode::kInconsistent, "%s must be an object, not %s", place_.c_str(), shown_json(object).c_str()));
  object_ = &empty_object();
}

std::string JsonMembers::place_of(std::string_view name) const {
  return place_.empty() ? shown_name(name) : place_ + "." + shown_name(name);
}

void JsonMembers::fail(Error error) {
  if (!*error_) *error_ = std::move(error);
}

void JsonMembers::allow(std::initializer_list<std::string_view> names) {
  for (const auto& item : object_->items()) {
    if (std::find(names.begin(), names.end(), item.key()) != names.end()) continue;
    std::string known;
    for (const std::string_view name : names) known += (known.empty() ? "; known are " : ", ") + std::string(name);
    fail(failure(ErrorCode::kInconsistent, "%s%s is unknown%s", place_.empty() ? "" : (place_ + ": ").c_str(),
                 shown_json(item.key()).c_str(), known.c_str()));
  }
}

bool JsonMembers::has(const char* name) const {
  const auto found = object_->find(name);
  return found != object_->end() && !found->is_null();
}

const Json* JsonMembers::find(const char* name) {
  const auto found = object_->find(name);
  if (found != object_->end()) return &*found;
  fail(failure(ErrorCode::kInconsistent, "%s is missing", place_of(name).c_str()));
  return nullptr;
}

void JsonMembers::wrong_type(const char* name, const Json& value, const char* expected) {
  fail(failure(ErrorCode::kInconsistent, "%s = %s is not %s", place_of(name).c_str(), shown_json(value).c_str(),
               expected));
}

double JsonMembers::number(const char* name, double low, double high) {
  const Json* const value = find(name);
  if (value == nullptr) return low;
  if (!value->is_number()) return wrong_type(name, *value, "a number"), low;
  const double number = value->get<double>();
  if (number >= low && number <= high) return number;
  fail(failure(ErrorCode::kOutOfRange, "%s = %g is not within %g to %g", place_of(name).c_str(), number, low, high));
  return low;
}

std::int64_t JsonMembers::integer(const char* name, std::int64_t low, std::int64_t high) {
  const Json* const value = find(name);
  if (value == nullptr) return low;
  if (!value->is_number_integer()) return wrong_type(name, *value, "an integer"), low;
  const bool too_large = value->is_number_unsigned() &&
                         value->get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  if (!too_large && value->get<std::int64_t>() >= low && value->get<std::int64_t>() <= high) {
    return value->get<std::int64_t>();
  }
  fail(failure(ErrorCode::kOutOfRange, "%s = %s is not within %lld to %lld", place_of(name).c_str(),
               shown_json(*value).c_str(), static_cast<long long>(low), static_cast<long long>(high)));
  return low;
}

bool JsonMembers::flag_or(const char* name, bool absent) {
  if (!has(name)) return absent;
  const Json& value = object_->at(name);
  if (!value.is_boolean()) return wrong_type(name, value, "true or false"), absent;
  return value.get<bool>();
}

std::string JsonMembers::text(const char* name) {
  const Json* const value = find(name);
  if (value == nullptr) return {};
  if (!value->is_string()) return wrong_type(name, *value, "a text"), std::string();
  return value->get<std::string>();
}

JsonMembers JsonMembers::child(const char* name) {
  const Json* const value = find(name);
  return {value != nullptr ? *value : empty_object(), place_of(name), *error_};
}

std::vector<JsonMembers> JsonMembers::children(const char* name) {
  std::vector<JsonMembers> all;
  const Json* const value = find(name);
  if (value == nullptr) return all;
  if (!value->is_array()) {
    wrong_type(name, *value, "a list");
    return all;
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    all.emplace_back((*value)[i], place_of(name) + "[" + std::to_string(i) + "]", *error_);
  }
  return all;
}

}  // namespace touchline::network
