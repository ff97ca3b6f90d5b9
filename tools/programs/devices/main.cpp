#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "hal/linux/standard_descriptors.h"
#include "tools/programs/command_line/command_line.h"
#include "tools/programs/devices/device_list.h"

int main(int argc, char** argv) {
  touchline::hal::reserve_standard_descriptors();
  constexpr int kExitDeviceFailure = 2;
  using namespace touchline;
  std::string camera, serial, gpio;
  bool json = false;
  CLI::App app{
      "Lists the devices that a board file can name: cameras (formats, sizes, rates, controls), serial ports and GPIO\n"
      "chips with their lines. Without options it lists all. It changes nothing and does not disturb a running "
      "touchline.",
      "touchline-devices"};
  add_examples(
      app,
      {{"touchline-devices", "list everything"},
       {"touchline-devices --camera /dev/video0", "show what this camera offers"},
       {"touchline-devices --gpio --json", "list the GPIO chips for a program"}},
      "A device can be named by its file or by a link to it (/dev/v4l/by-path/...), a GPIO chip also by its label.\n"
      "Exit codes: 0 success, 2 a named device is missing or cannot be opened, 64 the command line is wrong.");
  CLI::Option* cameras = app.add_option("--camera", camera, "Only cameras, or only this one")->expected(0, 1);
  CLI::Option* ports = app.add_option("--serial", serial, "Only serial ports, or only this one")->expected(0, 1);
  CLI::Option* chips = app.add_option("--gpio", gpio, "Only GPIO chips, or only this one")->expected(0, 1);
  for (CLI::Option* option : {cameras, ports, chips}) option->type_name("[DEVICE]");
  app.add_flag("--json", json, "Print one JSON object, for programs");
  if (const auto exit_code = parse_arguments(app, argc, argv)) return *exit_code;
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
