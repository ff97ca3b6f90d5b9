#include "tools/programs/replay/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchline::replay {
namespace {

void use_font(cairo_t& context, double size) {
  cairo_select_font_face(&context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
  cairo_set_font_size(&context, size);
}

}  // namespace

CanvasColor color_on_scale(std::span<const CanvasColor> scale, double place) {
  const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(scale.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), scale.size() - 2);
  const double t = at - static_cast<double>(i);
  const CanvasColor &a = scale[i], &b = scale[i + 1];
  return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

Pixels pixels_of(cairo_surface_t& surface) {
  cairo_surface_flush(&surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(&surface));
  const auto height = static_cast<std::size_t>(cairo_image_surface_get_height(&surface));
  return {{cairo_image_surface_get_data(&surface), stride * height},
          stride,
          static_cast<std::uint32_t>(cairo_image_surface_get_width(&surface)),
          static_cast<std::uint32_t>(height)};
}

SurfacePtr to_surface(const Frame& frame) {
  SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, frame.width_px, frame.height_px));
  std::uint8_t* data = cairo_image_surface_get_data(surface.get());
  if (data == nullptr) return surface;
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (std::size_t y = 0; y < frame.height_px; ++y) {
    for (std::size_t x = 0; x < frame.width_px; ++x) {
      const std::array<std::uint8_t, 3> rgb = to_rgb8(pixel_at(frame, x, y), color_space(frame.format));
      std::uint8_t* pixel = data + y * stride + 4 * x;
      pixel[0] = rgb[2], pixel[1] = rgb[1], pixel[2] = rgb[0], pixel[3] = 255;
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

void set_color(cairo_t& context, const CanvasColor& color, double alpha) {
  cairo_set_source_rgba(&context, color.r, color.g, color.b, alpha);
}

void draw_text(cairo_t& context, double x, double y, const std::string& text, const CanvasColor& color, double size) {
  use_font(context, size);
  cairo_move_to(&context, x, y);
  cairo_text_path(&context, text.c_str());
  cairo_set_line_join(&context, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_width(&context, std::max(2.0, size / 4.5));
  set_color(context, {0.0, 0.0, 0.0}, 0.85);
  cairo_stroke_preserve(&context);
  set_color(context, color);
  cairo_fill(&context);
}

double text_width(cairo_t& context, const std::string& text, double size) {
  use_font(context, size);
  cairo_text_extents_t extents;
  cairo_text_extents(&context, text.c_str(), &extents);
  return extents.x_advance;
}

Result<void> write_png(cairo_surface_t& surface, const std::string& path, const hal::OutputOptions& options) {
  std::string png;
  const auto append = [](void* out, const unsigned char* bytes, unsigned int size) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(bytes), size);
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_flush(&surface);
  if (const cairo_status_t status = cairo_surface_write_to_png_stream(&surface, append, &png);
      status != CAIRO_STATUS_SUCCESS) {
    return failure(ErrorCode::kIo, "%s: %s", path.c_str(), cairo_status_to_string(status));
  }
  return hal::write_file(path, png, options);
}

}  // namespace touchline::replay
