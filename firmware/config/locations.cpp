#include "firmware/config/locations.h"

namespace touchline::config {

const std::string& Locations::of(std::string_view key_path) const {
  while (!key_path.empty()) {
    if (const auto found = where_.find(key_path); found != where_.end()) return found->second;
    const std::size_t cut = key_path.find_last_of(".[");
    key_path = key_path.substr(0, cut == std::string_view::npos ? 0 : cut);
  }
  return file_;
}

}  // namespace touchline::config
