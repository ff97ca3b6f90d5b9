#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "firmware/device_list/device_list.h"
#include "hal/linux/standard_descriptors.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/devices/judge/judge_command.h"
#include "tools/programs/devices/lens_table.h"

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  constexpr int kExitDeviceFailure = 2;
  using namespace touchline;
  std::string camera, serial, gpio;
  bool json = false;
  CLI::App app{
      "Lists the devices that a board file can name: cameras (formats, sizes, rates, controls), serial ports and GPIO\n"
      "chips with their lines. Without options it lists all. It changes nothing and does not disturb a running "
      "touchline,\nexcept that --judge uses a camera alone and changes its exposure.",
      "touchline-devices"};
  add_examples(
      app,
      {{"touchline-devices", "list everything"},
       {"touchline-devices --camera /dev/video0", "show what this camera offers"},
       {"touchline-devices --gpio --json", "list the GPIO chips for a program"},
       {"touchline-devices --judge", "judge the first camera"},
       {"touchline-devices --judge /dev/video2 --mode yuyv,640x480,30", "judge this camera in this mode"},
       {"touchline-devices --judge --board board.toml", "judge the camera of a board file"},
       {"touchline-devices --judge --board boards/mock/board.toml", "try it in a simulation"},
       {"touchline-devices --lens", "compute heights and lenses for each league's field"}},
      "A device can be named by its file or by a link to it (/dev/v4l/by-path/...), a GPIO chip also by its label.\n"
      "Exit codes: 0 success, 1 the board file is wrong, 2 a named device is missing or cannot be opened,\n64 the "
      "command line is wrong.");
  CLI::Option* cameras = app.add_option("--camera", camera, "Only cameras, or only this one")->expected(0, 1);
  CLI::Option* ports = app.add_option("--serial", serial, "Only serial ports, or only this one")->expected(0, 1);
  CLI::Option* chips = app.add_option("--gpio", gpio, "Only GPIO chips, or only this one")->expected(0, 1);
  for (CLI::Option* option : {cameras, ports, chips}) option->type_name("[DEVICE]");
  app.add_flag("--json", json, "Print one JSON object, for programs");
  devices::JudgeRequest judged;
  CLI::Option* judge =
      app.add_option("--judge", judged.device,
                     "Measure for two minutes whether a camera is good enough, and write the text of a "
                     "hardware report.\nDEVICE: /dev/video0, an id of libcamera, or auto; default: the "
                     "first camera")
          ->expected(0, 1)
          ->type_name("[DEVICE]");
  app.add_option("--board", judged.board, "With --judge: camera, format, rate and exposure of this board file")
      ->type_name("FILE")
      ->needs(judge);
  app.add_option("--mode", judged.mode, "With --judge: FORMAT,WIDTHxHEIGHT,RATE, as in mjpg,1280x720,60")
      ->type_name("MODE")
      ->needs(judge);
  add_overrides(app, judged.overrides, "the board file")->needs("--board");
  bool no_motion = false;
  app.add_flag("--no-motion", no_motion, "With --judge: do not measure the rolling shutter")->needs(judge);
  std::string sensor;
  CLI::Option* lens = app.add_option("--lens", sensor,
                                     "Print at which height each lens sees the field of each league.\nSENSOR: "
                                     "WIDTHxHEIGHT,COLUMNS in mm and pixels, as in 5.02x3.75,1456")
                          ->expected(0, 1)
                          ->type_name("[SENSOR]");
  for (CLI::Option* other : {cameras, ports, chips}) {
    judge->excludes(other);
    lens->excludes(other);
  }
  lens->excludes(judge);
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
  judged.motion = !no_motion;
  if (judge->count() > 0) return devices::judge_command(judged);
  if (lens->count() > 0) return devices::lens_command(sensor);
  devices::Selection selection;
  const bool all = cameras->count() + ports->count() + chips->count() == 0;
  if (all || cameras->count() > 0) selection.camera = camera;
  selection.libcamera = selection.camera && selection.camera->empty();
  if (all || ports->count() > 0) selection.serial = serial;
  if (all || chips->count() > 0) selection.gpio = gpio;
  const devices::DeviceList list = devices::list_devices(selection);
  std::fputs((json ? devices::to_json(list) : devices::to_text(list)).c_str(), stdout);
  for (const std::string& error : list.errors) std::fprintf(stderr, "touchline-devices: %s\n", error.c_str());
  return list.errors.empty() ? 0 : kExitDeviceFailure;
}
