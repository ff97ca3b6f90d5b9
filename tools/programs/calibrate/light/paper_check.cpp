#include "tools/programs/calibrate/light/paper_check.h"

#include <algorithm>
#include <array>

#include "tools/programs/calibrate/light/floor_light.h"
#include "tools/programs/calibrate/light/light_fit.h"

namespace touchline::calibrate {

PaperCheck check_paper(const std::vector<hal::Picture>& pictures, const std::vector<std::uint8_t>& floor) {
  PaperCheck out;
  const auto all = static_cast<double>(std::count(floor.begin(), floor.end(), 1));
  for (std::size_t p = 0; p < pictures.size(); ++p) {
    const hal::Picture& picture = pictures[p];
    const std::size_t width = picture.width_px, height = picture.height_px;
    std::array<Plane, 3> planes;
    for (std::size_t c = 0; c < 3; ++c) {
      planes[c].resize(width * height);
      for (std::size_t i = 0; i < width * height; ++i) planes[c][i] = channel_value(picture, 3 * i + c);
    }
    const std::vector<std::uint8_t> plain = plain_floor(planes, floor, width, height);
    std::size_t others = 0, first = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      if (floor[i] == 0 || plain[i] != 0) continue;
      if (others == 0) first = i;
      ++others;
    }
    const double share = all > 0 ? static_cast<double>(others) / all : 0;
    if (share <= out.other_share) continue;
    out = {share, p, first % width, first / width};
  }
  return out;
}

}  // namespace touchline::calibrate
