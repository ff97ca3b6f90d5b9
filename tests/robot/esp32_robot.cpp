#include "tools/robot/examples/esp32_robot/esp32_robot.ino"
