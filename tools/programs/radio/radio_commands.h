#pragma once

#include "firmware/session.h"
#include "tools/programs/radio/motion_pattern.h"

namespace touchline::radio {

struct RadioOptions {
  SessionOptions session;
  int robot = 0;
  double duration_s = 0.0;  // 0: the default of the command
  double speed_mps = 0.0;   // 0: the default of the command
  double radius_m = 0.15;
  bool yes = false;    // do not ask whether robots may move
  bool write = false;  // write measured values after a question for each
  bool json = false;
  bool all = false;  // show all packets
};

/// Sends a pattern to one robot and shows all bytes. Returns the exit code.
int send_pattern(const RadioOptions& options, Pattern pattern);
/// Drives one robot on the field, measures its drive, and offers to write the values. Returns the exit code.
int measure_drive(const RadioOptions& options);

/// Prints the question and reads the answer. Returns false for anything but "y" and "yes", and if nobody can answer.
bool is_confirmed(const char* question);

}  // namespace touchline::radio
