#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace touchline::testing {

/// A folder for a test's files, which is removed at its end.
class FileFolder : public ::testing::Test {
 protected:
  FileFolder() : folder_(std::filesystem::temp_directory_path() / ("touchline-files-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~FileFolder() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name = "x.mcap") const { return (folder_ / name).string(); }

  static std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static void write(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  std::filesystem::path folder_;
};

}  // namespace touchline::testing
