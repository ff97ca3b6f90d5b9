#include "tools/programs/setup/color_mask.h"

#include <cairo.h>

#include <memory>

namespace touchline::setup {
namespace {

using Channels = calibrate::Channels;

// Returns the color whose box has this value; null for background.
const config::ColorEntry* color_of(const Channels& value, const std::vector<config::ColorEntry>& colors) {
  for (const config::ColorEntry& color : colors) {
    for (const config::ColorBoxEntry& box : color.box) {
      bool inside = true;
      for (std::size_t c = 0; c < value.size(); ++c)
        inside = inside && value[c] >= box.low[c] && value[c] <= box.high[c];
      if (inside) return &color;
    }
  }
  return nullptr;
}

cairo_status_t append(void* closure, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Result<std::string> color_change_mask(const calibrate::ChannelImage& picture,
                                      const std::vector<config::ColorEntry>& before,
                                      const std::vector<config::ColorEntry>& after) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, picture.width_px, picture.height_px), cairo_surface_destroy);
  unsigned char* rows = cairo_image_surface_get_data(surface.get());
  if (rows == nullptr) return Error{ErrorCode::kIo, "the mask of the change cannot be drawn"};
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int v = 0; v < picture.height_px; ++v) {
    auto* row = reinterpret_cast<std::uint32_t*>(rows + static_cast<std::ptrdiff_t>(v) * stride);
    for (int u = 0; u < picture.width_px; ++u) {
      const config::ColorEntry* was = color_of(picture.at(u, v), before);
      const config::ColorEntry* is = color_of(picture.at(u, v), after);
      const bool same = was == is || (was != nullptr && is != nullptr && was->name == is->name);
      constexpr std::uint32_t kOpaque = 0xff000000u;
      row[u] = same            ? 0u
               : is == nullptr ? kOpaque
                               : kOpaque | static_cast<std::uint32_t>(is->shown_rgb[0]) << 16u |
                                     static_cast<std::uint32_t>(is->shown_rgb[1]) << 8u | is->shown_rgb[2];
    }
  }
  cairo_surface_mark_dirty(surface.get());
  std::string png;
  if (cairo_surface_write_to_png_stream(surface.get(), append, &png) == CAIRO_STATUS_SUCCESS) return png;
  return Error{ErrorCode::kIo, "the mask of the change cannot be encoded"};
}

}  // namespace touchline::setup
