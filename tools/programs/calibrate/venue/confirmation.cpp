#include "tools/programs/calibrate/venue/confirmation.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace touchline::calibrate {

bool confirmed(const std::string& question) {
  if (isatty(STDIN_FILENO) == 0) return false;
  std::printf("%s [y/n] ", question.c_str());
  std::fflush(stdout);
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

}  // namespace touchline::calibrate
