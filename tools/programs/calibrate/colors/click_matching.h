#pragma once

#include <string>
#include <vector>

#include "tools/programs/calibrate/colors/clicks.h"
#include "tools/programs/calibrate/colors/patch_search.h"

namespace touchline::calibrate {

/// Whether a click was used.
struct ClickUse {
  bool used = false;
  std::string reason;  // reason why it was not used; empty if it was
};

/// Returns the index of the patch under the click (at most two pixels away), or of the patch that a rectangle covers by
/// more than half; patches.size() if there is none.
std::size_t patch_under(const Click& click, const ChannelImage& image, const std::vector<FoundPatch>& patches);

/// Grows a patch from a click that lies on none of the patches found. kNotFound, with the reason: as for
/// select_patch(), or no patch has the area of the region.
Result<FoundPatch> patch_from(const Click& click, const ChannelImage& image, const std::vector<std::uint8_t>& inside,
                              const CameraModel& camera, const std::vector<PatchSize>& sizes);

/// Returns text such as "3 (a.png, red at 120,80)" for messages; clicks are counted from 0, as in their file.
std::string describe_click(std::size_t number, const Click& click);

}  // namespace touchline::calibrate
