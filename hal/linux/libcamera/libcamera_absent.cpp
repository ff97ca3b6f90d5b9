// Takes the place of libcamera_link.cpp if the library is not installed.
#include "hal/linux/libcamera/libcamera_link.h"

namespace touchline::hal {

std::unique_ptr<LibcameraLink> make_libcamera_link() { return nullptr; }

}  // namespace touchline::hal
