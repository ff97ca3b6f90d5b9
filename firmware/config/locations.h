#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace touchline::config {

/// Stores file and line of each key, for messages of checks that follow the reading.
class Locations {
 public:
  explicit Locations(std::string file = {}) : file_(std::move(file)) {}
  void note(std::string_view key_path, std::string_view where) {
    where_.insert_or_assign(std::string(key_path), where);
  }
  /// Returns "file:line" of the key, or of the nearest table around it ("own.robot[1].colors", "own.robot[1]", ...), or
  /// the file.
  [[nodiscard]] const std::string& of(std::string_view key_path) const;
  [[nodiscard]] bool has(std::string_view key_path) const { return where_.find(key_path) != where_.end(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Paths of the keys, with their "file:line".
  [[nodiscard]] const std::map<std::string, std::string, std::less<>>& all() const { return where_; }

 private:
  std::string file_;
  std::map<std::string, std::string, std::less<>> where_;
};

}  // namespace touchline::config
