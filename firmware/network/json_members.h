#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.h"

namespace touchline::network {

/// Parses a text of any length and content. kCorruptFrame: it is no JSON object; kOutOfRange: it is nested too deeply.
Result<nlohmann::json> parse_json_object(std::string_view text);

/// Reads the members of an object strictly: what is unknown, missing, of another type or out of range is an error that
/// names the member and its value: `step.frames = 0 is not within 1 to 600`. The first error is kept, and the reader
/// goes on with values within the limits.
class JsonMembers {
 public:
  /// `place`: where the object stands, for example "step"; empty for the whole message. `error` is shared by the
  /// readers of a message.
  JsonMembers(const nlohmann::json& object, std::string place, std::optional<Error>& error);

  /// Members with other names than these are errors.
  void allow(std::initializer_list<std::string_view> names);

  [[nodiscard]] bool has(const char* name) const;
  double number(const char* name, double low, double high);
  double number_or(const char* name, double low, double high, double absent) {
    return has(name) ? number(name, low, high) : absent;
  }
  std::int64_t integer(const char* name, std::int64_t low, std::int64_t high);
  bool flag_or(const char* name, bool absent);
  std::string text(const char* name);
  std::string text_or(const char* name, const std::string& absent) { return has(name) ? text(name) : absent; }
  /// Returns the reader of a member that is an object; an empty object if it is something else.
  JsonMembers child(const char* name);
  /// Returns the readers of the members of a list; none if it is something else.
  std::vector<JsonMembers> children(const char* name);

  [[nodiscard]] const nlohmann::json& object() const { return *object_; }
  /// Returns "step.frames" for a member of "step".
  [[nodiscard]] std::string place_of(std::string_view name) const;
  /// Keeps this error unless there is an earlier one.
  void fail(Error error);
  [[nodiscard]] bool failed() const { return error_->has_value(); }

 private:
  const nlohmann::json* find(const char* name);
  void wrong_type(const char* name, const nlohmann::json& value, const char* expected);

  const nlohmann::json* object_;
  std::string place_;
  std::optional<Error>* error_;
};

/// Returns the name of a member for a message: printable, and cut off if it is long.
std::string shown_name(std::string_view name);
/// Returns the value as text for a message: printable, and cut off if it is long.
std::string shown_json(const nlohmann::json& value);

}  // namespace touchline::network
