#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchline::devices {

struct JudgeRequest {
  std::string device;                  // "": the camera of the board file, or the first camera found
  std::string mode;                    // "mjpg,1280x720,60"; "": the mode of the board file, or chosen
  std::string board;                   // board file; "": none
  std::vector<std::string> overrides;  // "key=value" for keys of the board file
  bool motion = true;
};

/// Judges a camera, prints progress to standard error and the result to standard output. Returns the exit code.
int judge_command(const JudgeRequest& request);

}  // namespace touchline::devices
