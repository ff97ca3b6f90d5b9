#include "tools/programs/setup/job.h"

namespace touchline::setup {

Result<void> JobOutput::picture(const std::string& member, const hal::Picture& picture, bool is_list) const {
  TOUCHLINE_TRY_ASSIGN(const std::string png, hal::encode_png(picture));
  encoded_picture(member, picture.width_px, picture.height_px, png, is_list);
  return {};
}

void JobOutput::encoded_picture(const std::string& member, std::uint32_t width_px, std::uint32_t height_px,
                                std::string_view bytes, bool is_list) const {
  reporter_->send(
      {{"type", "picture"}, {"member", member}, {"list", is_list}, {"width_px", width_px}, {"height_px", height_px}},
      bytes);
}

}  // namespace touchline::setup
