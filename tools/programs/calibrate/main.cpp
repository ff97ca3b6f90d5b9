#include <CLI/CLI.hpp>

#include "hal/linux/standard_descriptors.h"
#include "tools/programs/calibrate/colors/colors_command.h"
#include "tools/programs/calibrate/field/field_command.h"
#include "tools/programs/calibrate/light/light_command.h"
#include "tools/programs/calibrate/noise/noise_command.h"
#include "tools/programs/calibrate/picture/picture_command.h"
#include "tools/programs/command_line/command_line.h"

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  using namespace touchline::calibrate;
  CLI::App app(
      "Calibrates camera, light, colors and noise for a venue; each command writes its sections of the venue file",
      "touchline-calibrate");
  app.require_subcommand(1);
  PictureCommand picture;
  FieldCommand field;
  LightCommand light;
  ColorsCommand colors;
  NoiseCommand noise;
  CLI::App* picture_app = app.add_subcommand("picture", "Take pictures with the board's camera for the other commands");
  CLI::App* field_app = app.add_subcommand("field", "Find the camera model from the border of the field");
  CLI::App* light_app =
      app.add_subcommand("light", "Measure the illumination map from pictures of the field or of grey paper");
  CLI::App* colors_app = app.add_subcommand("colors", "Learn color boxes from pictures of robots and ball");
  CLI::App* noise_app = app.add_subcommand("noise", "Measure the noise of standing robots for the tracking filters");
  picture.add_options(*picture_app);
  field.add_options(*field_app);
  light.add_options(*light_app);
  colors.add_options(*colors_app);
  noise.add_options(*noise_app);
  touchline::add_examples(
      app,
      {{"touchline-calibrate picture --board board.toml --out empty.png", "take a picture of the empty field"},
       {"touchline-calibrate field --picture empty.png --venue venue.toml --field-preset vsss --camera-height 2.4",
        "find the camera model"},
       {"touchline-calibrate light --picture empty.png --venue venue.toml --surface field", "measure the light"},
       {"touchline-calibrate colors --picture robots.png --venue venue.toml --team team.toml", "learn the colors"}});
  if (const auto exit_code = touchline::parse_arguments(app, argc, argv)) return *exit_code;
  if (picture_app->parsed()) return picture.run();
  const touchline::Result<void> done = field_app->parsed()   ? field.run()
                                       : light_app->parsed() ? light.run()
                                       : noise_app->parsed() ? noise.run()
                                                             : colors.run();
  return done.ok() ? touchline::kExitOk : touchline::fail("touchline-calibrate", done.text());
}
