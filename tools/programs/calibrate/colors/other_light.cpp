#include "tools/programs/calibrate/colors/other_light.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/programs/command_line/formatted.h"

namespace touchline::calibrate {

Result<CameraPicture> in_other_light(const CameraPicture& picture, const OtherLight& light) {
  const Frame frame = picture.frame();
  hal::Picture changed = picture_of(frame);
  for (std::size_t i = 0; i < changed.rgb8.size(); ++i) {
    const double value = std::round(changed.rgb8[i] * light.gain[i % 3]);
    changed.rgb8[i] = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
  }
  // The picture is written and read like any other, so that it is converted to the camera's format exactly as in a
  // replay.
  std::error_code unknown;
  const std::string path = (std::filesystem::temp_directory_path(unknown) /
                            formatted("touchline-light-%d.png", static_cast<int>(::getpid())))
                               .string();
  TOUCHLINE_TRY(hal::write_picture(path, changed));
  Result<CameraPicture> out = CameraPicture::load(path, frame.format);
  std::filesystem::remove(path, unknown);
  return out;
}

Result<void> check_other_light(const std::string& venue, const std::string& team,
                               const std::map<std::string, CameraPicture>& pictures, const VisibleByPicture& visible,
                               SelfCheck& check) {
  for (const OtherLight& light : kOtherLights) {
    std::map<std::string, CameraPicture> changed;
    for (const auto& [image, picture] : pictures) {
      TOUCHLINE_TRY_ASSIGN(changed[image], in_other_light(picture, light));
    }
    TOUCHLINE_TRY_ASSIGN(const SelfCheck there, self_check(venue, team, changed, visible, ""));
    check.other_light.push_back({light.name, there.robots_explained()});
  }
  return {};
}

}  // namespace touchline::calibrate
