#include "firmware/config/error_list.h"

namespace touchline::config {

std::string error_line(std::string_view where, std::string_view key, std::string_view message) {
  std::string line(where);
  if (!line.empty()) line += ": ";
  if (!key.empty()) line.append(key).append(": ");
  line += message;
  return line;
}

void ErrorList::add(std::string_view where, std::string_view key, std::string_view message) {
  messages_.push_back(error_line(where, key, message));
}

void ErrorList::add(const Result<void>& result) {
  if (!result.ok()) messages_.push_back(result.text());
}

Result<void> ErrorList::result(ErrorCode code) const {
  if (messages_.empty()) return {};
  Error error{code, {}};
  for (const std::string& message : messages_) {
    if (!error.text.empty()) error.text.append("\n");
    error.text.append(message);
  }
  return error;
}

}  // namespace touchline::config
