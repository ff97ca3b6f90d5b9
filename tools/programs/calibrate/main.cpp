#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "tools/programs/calibrate/commands.h"
#include "tools/programs/command_line/command_line.h"

namespace touchline::calibrate {

std::optional<std::vector<double>> numbers_of(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (numbers.size() < count) {
    double value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    at = rest;
    if (numbers.size() < count) {
      if (at == end || *at != ',') return std::nullopt;
      ++at;
    }
  }
  if (at != end) return std::nullopt;
  return numbers;
}

int refuse(const std::string& message) {
  std::fprintf(stderr, "touchline-calibrate: %s\n", message.c_str());
  return 1;
}

}  // namespace touchline::calibrate

int main(int argc, char** argv) {
  using namespace touchline::calibrate;
  CLI::App app("Finds what the pipeline must know of a hall and writes it into a venue file, a section a command",
               "touchline-calibrate");
  app.require_subcommand(1);
  PictureCommand picture;
  FieldCommand field;
  LightCommand light;
  ColorsCommand colors;
  CLI::App* picture_app =
      app.add_subcommand("picture", "Pictures from the board's own camera, as the other commands want them");
  CLI::App* field_app =
      app.add_subcommand("field", "Camera model from the field's border, found without a click or from its corners");
  CLI::App* light_app = app.add_subcommand("light", "Illumination map from pictures of a grey field");
  CLI::App* colors_app = app.add_subcommand("colors", "Color boxes from clicks on patches and ball");
  picture.add_options(*picture_app);
  field.add_options(*field_app);
  light.add_options(*light_app);
  colors.add_options(*colors_app);
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;
  if (picture_app->parsed()) return picture.run();
  if (field_app->parsed()) return field.run();
  if (light_app->parsed()) return light.run();
  return colors.run();
}
