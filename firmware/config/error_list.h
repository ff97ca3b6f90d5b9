#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "hal/result.h"

namespace touchline::config {

/// Returns "where: key: message". `where`: "file:line" or "file"; `key`: path of the key. Both may be empty. Control
/// characters in key and message, which a file may contain, are shown as numbers (backslash, u, four digits).
std::string error_line(std::string_view where, std::string_view key, std::string_view message);

/// Collects the errors of the configuration files, so that a person can correct them together.
class ErrorList {
 public:
  /// Adds an error_line().
  void add(std::string_view where, std::string_view key, std::string_view message);
  /// Adds the message of an error.
  void add(const Result<void>& result);

  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] std::size_t size() const { return messages_.size(); }
  /// Returns success if the list is empty; else an error with all messages, one per line.
  [[nodiscard]] Result<void> result(ErrorCode code = ErrorCode::kInconsistent) const;

 private:
  std::vector<std::string> messages_;
};

}  // namespace touchline::config
