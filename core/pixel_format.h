#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/color_space.h"

// Table of the pixel formats that cameras deliver. All properties of a format follow from its row. A new format needs
// an enumerator and a row; a color kernel is needed only for a new Packing (docs/cameras.md).
namespace touchline {

#define TOUCHLINE_PIXEL_FORMATS(FORMAT) \
  FORMAT(kRgb24)                        \
  FORMAT(kBgr24) FORMAT(kYuyv) FORMAT(kUyvy) FORMAT(kNv12) FORMAT(kI420) FORMAT(kXrgb8888) FORMAT(kYuvj422p)

enum class PixelFormat : std::uint8_t {
#define TOUCHLINE_FORMAT(name) name,
  TOUCHLINE_PIXEL_FORMATS(TOUCHLINE_FORMAT)
#undef TOUCHLINE_FORMAT
};

/// Arrangement of samples in memory. Each packing needs its own color kernel.
enum class Packing : std::uint8_t {
  kPacked24,    // three bytes per pixel
  kPacked32,    // four bytes per pixel, the last of them unused
  kPacked422,   // four bytes for two pixels that share chroma
  kSemiPlanar,  // luma, and a plane of interleaved U and V for 2 x 2 pixels
  kPlanar,      // luma, and one plane each of U and V for 2 x 1 or 2 x 2 pixels
};

constexpr std::size_t kMaxPlanes = 3;

/// Position of a channel's samples in memory: pixel (u, v) uses byte offset + (u >> shift_u) * step of row v >> shift_v
/// of the plane.
struct ChannelLayout {
  std::uint8_t plane = 0, offset = 0, step = 1;
  std::uint8_t shift_u = 0, shift_v = 0;  // log2 of the number of pixels that share a sample, in each direction

  [[nodiscard]] constexpr std::size_t byte(std::size_t u) const { return offset + (u >> shift_u) * step; }
};

struct PixelFormatInfo {
  PixelFormat format;
  std::string_view word;  // camera.format in board.toml
  Packing packing;
  ColorSpace space;
  std::uint8_t planes;
  std::array<ChannelLayout, 3> channel;  // R, G, B or Y, U, V
  std::uint32_t v4l2;                    // V4L2's code, all planes in one buffer
  std::uint32_t v4l2_planar;             // V4L2's code with one buffer per plane; 0: none
  std::uint32_t drm;                     // DRM's code, which libcamera uses; RGB in reverse order of bytes
};

/// Four-character code of a format (V4L2, DRM).
constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  std::uint32_t code = 0;
  for (std::size_t i = 4; i > 0; --i) code = code << 8u | static_cast<unsigned char>(letters[i - 1]);
  return code;
}

// clang-format off
inline constexpr std::array kPixelFormatTable{
    PixelFormatInfo{PixelFormat::kRgb24, "rgb24", Packing::kPacked24, ColorSpace::kRgb, 1,
                    {{{0, 0, 3}, {0, 1, 3}, {0, 2, 3}}},
                    fourcc("RGB3"), 0, fourcc("BG24")},
    PixelFormatInfo{PixelFormat::kBgr24, "bgr24", Packing::kPacked24, ColorSpace::kRgb, 1,
                    {{{0, 2, 3}, {0, 1, 3}, {0, 0, 3}}},
                    fourcc("BGR3"), 0, fourcc("RG24")},
    PixelFormatInfo{PixelFormat::kYuyv, "yuyv", Packing::kPacked422, ColorSpace::kYuv, 1,
                    {{{0, 0, 2}, {0, 1, 4, 1, 0}, {0, 3, 4, 1, 0}}},
                    fourcc("YUYV"), 0, fourcc("YUYV")},
    PixelFormatInfo{PixelFormat::kUyvy, "uyvy", Packing::kPacked422, ColorSpace::kYuv, 1,
                    {{{0, 1, 2}, {0, 0, 4, 1, 0}, {0, 2, 4, 1, 0}}},
                    fourcc("UYVY"), 0, fourcc("UYVY")},
    PixelFormatInfo{PixelFormat::kNv12, "nv12", Packing::kSemiPlanar, ColorSpace::kYuv, 2,
                    {{{0, 0, 1}, {1, 0, 2, 1, 1}, {1, 1, 2, 1, 1}}},
                    fourcc("NV12"), fourcc("NM12"), fourcc("NV12")},
    PixelFormatInfo{PixelFormat::kI420, "i420", Packing::kPlanar, ColorSpace::kYuv, 3,
                    {{{0, 0, 1}, {1, 0, 1, 1, 1}, {2, 0, 1, 1, 1}}},
                    fourcc("YU12"), fourcc("YM12"), fourcc("YU12")},
    PixelFormatInfo{PixelFormat::kXrgb8888, "xrgb8888", Packing::kPacked32, ColorSpace::kRgb, 1,
                    {{{0, 2, 4}, {0, 1, 4}, {0, 0, 4}}},
                    fourcc("XR24"), 0, fourcc("XR24")},
    PixelFormatInfo{PixelFormat::kYuvj422p, "yuvj422p", Packing::kPlanar, ColorSpace::kYuvFullRange, 3,
                    {{{0, 0, 1}, {1, 0, 1, 1, 0}, {2, 0, 1, 1, 0}}},
                    fourcc("422P"), fourcc("YM16"), fourcc("YU16")},
};
// clang-format on

constexpr const PixelFormatInfo& info_of(PixelFormat format) {
  return kPixelFormatTable[static_cast<std::size_t>(format)];
}
static_assert(std::all_of(kPixelFormatTable.begin(), kPixelFormatTable.end(),
                          [](const PixelFormatInfo& row) { return &row == &info_of(row.format); }),
              "the table must have the order of the enumerators");

constexpr ColorSpace color_space(PixelFormat format) { return info_of(format).space; }

/// Returns whether pixel pairs (2k, 2k + 1) of a row share a chroma sample.
constexpr bool shares_chroma(PixelFormat format) { return info_of(format).channel[1].shift_u > 0; }

/// Returns the bytes of a row of the plane; 0 if the format has no such plane. With shared chroma, a row of odd width
/// contains the complete chroma of its last, incomplete pair.
constexpr std::size_t row_bytes(PixelFormat format, std::size_t plane, std::size_t width_px) {
  std::size_t bytes = 0;
  for (const ChannelLayout& channel : info_of(format).channel) {
    const std::size_t samples = (width_px + (std::size_t{1} << channel.shift_u) - 1) >> channel.shift_u;
    if (channel.plane == plane) bytes = std::max(bytes, samples * channel.step);
  }
  return bytes;
}

/// Returns the row of the plane that contains the samples of picture row v.
constexpr std::size_t plane_row(PixelFormat format, std::size_t plane, std::size_t v) {
  return plane == 0 ? v : v >> info_of(format).channel[plane].shift_v;
}

/// Returns the number of rows of a plane, which the format must have.
constexpr std::size_t plane_rows(PixelFormat format, std::size_t plane, std::size_t height_px) {
  return plane_row(format, plane, height_px - 1) + 1;
}

/// Returns the bytes from the first to the last pixel of a plane; the last row needs no padding. 0 if the format has no
/// such plane.
constexpr std::size_t plane_bytes(PixelFormat format, std::size_t plane, std::size_t width_px, std::size_t height_px,
                                  std::size_t stride_bytes) {
  const std::size_t row = row_bytes(format, plane, width_px);
  return row == 0 ? 0 : (plane_rows(format, plane, height_px) - 1) * stride_bytes + row;
}

/// Returns the stride of a plane, computed from the stride of the first plane, for drivers that report only the first
/// one. Strides have the same ratio as the bytes of a row in the two planes (V4L2, struct v4l2_pix_format).
constexpr std::uint32_t plane_stride(PixelFormat format, std::size_t plane, std::uint32_t first_stride_bytes) {
  if (plane == 0) return first_stride_bytes;
  const ChannelLayout& chroma = info_of(format).channel[plane];
  return first_stride_bytes * chroma.step >> chroma.shift_u;
}

/// A picture whose planes follow each other in one buffer.
struct PictureLayout {
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
  std::array<std::size_t, kMaxPlanes> offset_bytes{};
  std::size_t bytes = 0;
};

/// `stride_bytes`: stride of each plane that the format has, at least row_bytes().
constexpr PictureLayout picture_layout(PixelFormat format, std::size_t height_px,
                                       const std::array<std::uint32_t, kMaxPlanes>& stride_bytes) {
  PictureLayout layout;
  for (std::size_t plane = 0; plane < info_of(format).planes; ++plane) {
    layout.stride_bytes[plane] = stride_bytes[plane];
    layout.offset_bytes[plane] = layout.bytes;
    layout.bytes += plane_rows(format, plane, height_px) * stride_bytes[plane];
  }
  return layout;
}

/// As above; rows have no padding, or are padded to a multiple of `alignment_bytes`.
constexpr PictureLayout picture_layout(PixelFormat format, std::size_t width_px, std::size_t height_px,
                                       std::size_t alignment_bytes = 1) {
  std::array<std::uint32_t, kMaxPlanes> stride_bytes{};
  for (std::size_t plane = 0; plane < info_of(format).planes; ++plane) {
    const std::size_t row = row_bytes(format, plane, width_px);
    stride_bytes[plane] = static_cast<std::uint32_t>((row + alignment_bytes - 1) / alignment_bytes * alignment_bytes);
  }
  return picture_layout(format, height_px, stride_bytes);
}

}  // namespace touchline
