#include "tools/robot/examples/esp32_dongle/esp32_dongle.ino"
