#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace touchline::testing {

// Prefix for programs that draw text, because the font library never frees its fonts, which the leak sanitizer would
// report.
inline const std::string kKeepsFonts = "ASAN_OPTIONS=detect_leaks=0 ";

/// Runs a program in a temporary folder that is removed after the test.
class ProgramFolder : public ::testing::Test {
 protected:
  ProgramFolder()
      : folder_(std::filesystem::path(::testing::TempDir()) / ("touchline_program_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ProgramFolder() override {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(path(name));
    std::ostringstream all;
    all << file.rdbuf();
    return all.str();
  }
  /// Returns true if the exit code is 0. The output is in the file "out".
  [[nodiscard]] bool run_program(const std::string& program, const std::string& arguments) const {
    const std::string command = program + " " + arguments + " >" + path("out") + " 2>&1";
    return std::system(command.c_str()) == 0;  // NOLINT(cert-env33-c,concurrency-mt-unsafe): the program under test
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace touchline::testing
