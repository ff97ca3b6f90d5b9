#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "firmware/config/configuration.h"
#include "hal/result.h"

namespace touchline::config {

/// A folder with a valid board, venue and team file, for tests that introduce one error.
class ConfigFiles : public ::testing::Test {
 protected:
  ConfigFiles();
  ~ConfigFiles() override;

  static std::string read(const std::filesystem::path& path);
  void write(const std::string& name, const std::string& text) const;
  /// Replaces a text that the file contains exactly once.
  void replace(const std::string& name, const std::string& from, const std::string& to) const;
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  Result<void> load(std::vector<std::string> overrides = {});
  /// Returns the message of result_, each line ended by a newline, without the name of the folder.
  [[nodiscard]] std::string errors() const;
  /// Loads the files, expects errors, and returns the messages.
  std::string refusal(std::vector<std::string> overrides = {});

  std::filesystem::path folder_;
  std::unique_ptr<Configuration> configuration_ = std::make_unique<Configuration>();
  Result<void> result_;  // result of the last load()
};

}  // namespace touchline::config
