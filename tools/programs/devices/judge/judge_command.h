#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchline::devices {

struct JudgeRequest {
  std::string device;                  // "": the camera of the board file, or the first one
  std::string mode;                    // "mjpg,1280x720,60"; "": of the board file, or chosen
  std::string board;                   // "": none
  std::vector<std::string> overrides;  // of the board file
  bool motion = true;
};

/// Judges a camera, prints progress to standard error and the result to standard output. Returns the exit code.
int judge_command(const JudgeRequest& request);

}  // namespace touchline::devices
