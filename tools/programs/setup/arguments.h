#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/types.h"
#include "hal/result.h"

namespace touchline::setup {

/// Reads the members of a command. All errors are kInconsistent and name the member. Numbers must be finite.
class Arguments {
 public:
  explicit Arguments(const nlohmann::json& command) : command_(&command) {}

  [[nodiscard]] bool has(const char* name) const;
  [[nodiscard]] const nlohmann::json& operator[](const char* name) const { return command_->at(name); }
  /// Returns the number, which must be from `low` to `high`.
  [[nodiscard]] Result<double> number(const char* name, double low, double high) const;
  /// As above, or `absent` if the member is missing or null.
  [[nodiscard]] Result<double> number(const char* name, double low, double high, double absent) const;
  [[nodiscard]] Result<std::string> text(const char* name) const;
  [[nodiscard]] Result<std::string> text(const char* name, const std::string& absent) const;
  [[nodiscard]] Result<bool> flag(const char* name, bool absent) const;
  [[nodiscard]] Result<std::vector<std::string>> texts(const char* name) const;
  /// Returns the points [[u, v], ...], each within the largest picture.
  [[nodiscard]] Result<std::vector<PixelPoint>> pixels(const char* name, std::size_t count) const;

 private:
  const nlohmann::json* command_;
};

}  // namespace touchline::setup
