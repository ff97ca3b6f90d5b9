#pragma once

#include <cairo.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/types.h"
#include "hal/files/output_file.h"
#include "hal/result.h"

namespace touchline::replay {

/// Drawing color, 0 to 1 per channel as Cairo takes it.
struct CanvasColor {
  double r = 1.0, g = 1.0, b = 1.0;
};
/// Converts red, green and blue from 0 to 255.
template <class Rgb>
CanvasColor canvas_color(const Rgb& rgb) {
  return {rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0};
}
/// Returns the color at `place`, 0 to 1, on a scale with these colors at equal distances.
CanvasColor color_on_scale(std::span<const CanvasColor> scale, double place);

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct ContextDeleter {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using SurfacePtr = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
using ContextPtr = std::unique_ptr<cairo_t, ContextDeleter>;

/// View of the pixels of a Cairo image surface: B, G, R and an unused byte on little-endian machines.
struct Pixels {
  std::span<const std::uint8_t> bgrx;
  std::size_t stride_bytes = 0;
  std::uint32_t width = 0, height = 0;
};
Pixels pixels_of(cairo_surface_t& surface);

/// Converts a frame of any format to an RGB surface (YUV: ITU-R BT.601).
SurfacePtr to_surface(const Frame& frame);

/// Draws text with a dark outline, which makes it legible on any background. `x`, `y`: left end of the baseline.
void draw_text(cairo_t& context, double x, double y, const std::string& text, const CanvasColor& color, double size);
double text_width(cairo_t& context, const std::string& text, double size);

/// Writes a PNG file with hal::OutputFile. The message of an error names the file and the cause.
Result<void> write_png(cairo_surface_t& surface, const std::string& path, const hal::OutputOptions& options = {});

void set_color(cairo_t& context, const CanvasColor& color, double alpha = 1.0);

}  // namespace touchline::replay
