#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/config/configuration.h"

namespace touchline::config {

/// A folder with a sound board, venue and team, for tests that break one thing of them.
class ConfigFiles : public ::testing::Test {
 protected:
  ConfigFiles();
  ~ConfigFiles() override;

  static std::string read(const std::filesystem::path& path);
  void write(const std::string& name, const std::string& text) const;
  /// In the file, exactly once.
  void replace(const std::string& name, const std::string& from, const std::string& to) const;
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  Status load(std::vector<std::string> overrides = {});
  /// All lines of problems with the folder's name taken off.
  [[nodiscard]] std::string problems() const;
  /// Loads, expects it to fail, and gives the problems.
  std::string refusal(std::vector<std::string> overrides = {});

  std::filesystem::path folder_;
  std::unique_ptr<Configuration> configuration_ = std::make_unique<Configuration>();
  Problems problems_;
};

}  // namespace touchline::config
