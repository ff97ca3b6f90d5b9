#include "tools/programs/command_line/command_line.h"

#include <charconv>
#include <iostream>
#include <sstream>
#include <utility>

namespace touchline {

int fail(std::string_view program, std::string_view message, int exit_code) {
  std::cerr << program << ": " << message << '\n';
  return exit_code;
}

CLI::Option* add_overrides(CLI::App& app, std::vector<std::string>& overrides, const std::string& files) {
  return app
      .add_option("--set", overrides, "Override a key of " + files + ", e.g. camera.exposure_us=4000; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

CLI::Validator number_range(double low, double high) {
  std::ostringstream range;
  range << "from " << low << " to " << high;
  const std::string description = range.str();
  return {[=](const std::string& text) {
            double value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool inside =
                error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
            return inside ? std::string() : "\"" + text + "\" is not a number " + description;
          },
          "FLOAT " + description};
}

CLI::Validator name_ending(std::vector<std::string> endings) {
  return {[endings = std::move(endings)](const std::string& path) {
            std::string names;
            for (const std::string& ending : endings) {
              if (path.ends_with(ending)) return std::string();
              names += (names.empty() ? "" : " or ") + ending;
            }
            return path + ": the name must end in " + names;
          },
          ""};
}

std::string ignored_option(const CLI::App& app, const CLI::App& command) {
  if (!command.parsed()) return {};
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0)
      return option->get_name() + " stands before " + command.get_name() + ", which does not use it";
  }
  return {};
}

}  // namespace touchline
