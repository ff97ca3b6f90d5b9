#include "firmware/config/problems.h"

namespace touchline::config {

void Problems::add(std::string_view where, std::string_view key, std::string_view message) {
  std::string line(where);
  if (!line.empty()) line += ": ";
  if (!key.empty()) line.append(key).append(": ");
  line += message;
  lines_.push_back(std::move(line));
}

std::string Problems::text() const {
  std::string all;
  for (const std::string& line : lines_) all.append(line).append("\n");
  return all;
}

const std::string& Locations::of(std::string_view key_path) const {
  while (!key_path.empty()) {
    if (const auto found = where_.find(key_path); found != where_.end()) return found->second;
    const std::size_t cut = key_path.find_last_of(".[");
    key_path = key_path.substr(0, cut == std::string_view::npos ? 0 : cut);
  }
  return file_;
}

}  // namespace touchline::config
