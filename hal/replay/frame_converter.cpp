#include "hal/replay/frame_converter.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>

namespace touchline::hal::ffmpeg {
namespace {

// Flags of the scaler: results are the same on every CPU, and chroma is interpolated in both directions.
constexpr int kScalerFlags = SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP | SWS_ACCURATE_RND | SWS_BITEXACT;
// Number of rows from which a video without a named matrix uses ITU-R BT.709; below it (standard definition), BT.601.
constexpr int kFirstHdRow = 720;

bool full_range(const AVFrame& frame) {
  switch (frame.format) {
    case AV_PIX_FMT_YUVJ420P:
    case AV_PIX_FMT_YUVJ422P:
    case AV_PIX_FMT_YUVJ444P:
    case AV_PIX_FMT_YUVJ440P:
    case AV_PIX_FMT_YUVJ411P:
      return true;
    default:
      return frame.color_range == AVCOL_RANGE_JPEG;
  }
}

const int* matrix_of(const AVFrame& frame) {
  int space = SWS_CS_ITU601;
  switch (frame.colorspace) {
    case AVCOL_SPC_BT709:
      space = SWS_CS_ITU709;
      break;
    case AVCOL_SPC_FCC:
      space = SWS_CS_FCC;
      break;
    case AVCOL_SPC_SMPTE240M:
      space = SWS_CS_SMPTE240M;
      break;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      space = SWS_CS_BT2020;
      break;
    case AVCOL_SPC_UNSPECIFIED:
      space = frame.height >= kFirstHdRow ? SWS_CS_ITU709 : SWS_CS_ITU601;
      break;
    default:
      break;
  }
  return sws_getCoefficients(space);
}

// swscale expects the position of chroma in 256ths of a pixel from the first luma sample.
void set_chroma_position(SwsContext* scaler, const AVFrame& frame, const AVPixFmtDescriptor& layout) {
  const bool centered = frame.chroma_location == AVCHROMA_LOC_CENTER || frame.chroma_location == AVCHROMA_LOC_TOP;
  const bool on_top = frame.chroma_location == AVCHROMA_LOC_TOPLEFT || frame.chroma_location == AVCHROMA_LOC_TOP;
  if (layout.log2_chroma_w == 1) av_opt_set_int(scaler, "src_h_chr_pos", centered ? 128 : 0, 0);
  if (layout.log2_chroma_h == 1) av_opt_set_int(scaler, "src_v_chr_pos", on_top ? 0 : 128, 0);
}

/// True for RGB, gray and palette layouts.
bool stored_as_rgb(const AVFrame& source) {
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(source.format));
  return layout != nullptr &&
         ((layout->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) != 0 || layout->nb_components <= 2);
}

}  // namespace

Result<void> FrameConverter::convert(const AVFrame& source, SourceFrame& out) {
  // Checks the size before memory for conversions is allocated.
  TOUCHLINE_TRY(out.resize(format_, static_cast<std::uint32_t>(std::max(source.width, 0)),
                           static_cast<std::uint32_t>(std::max(source.height, 0))));
  const bool through_rgb = stored_as_rgb(source) || color_space(format_) == ColorSpace::kRgb;
  if (through_rgb && read_rgb(source)) return hal::convert(rgb_, format_, out);
  if (!through_rgb && to_yuv(source, out)) return {};
  return failure(ErrorCode::kUnsupported, "cannot be converted to the requested format");
}

// Reads RGB layouts exactly, with 8 bits per channel, and converts YUV.
bool FrameConverter::read_rgb(const AVFrame& source) {
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(source.format));
  if (layout == nullptr) return false;
  const auto width = static_cast<std::size_t>(source.width);
  const auto height = static_cast<std::size_t>(source.height);
  Picture& picture = rgb_.values;
  picture.width_px = static_cast<std::uint32_t>(width);
  picture.height_px = static_cast<std::uint32_t>(height);
  picture.rgb8.resize(3 * width * height + AV_INPUT_BUFFER_PADDING_SIZE);  // the scaler writes beyond the end
  if (!stored_as_rgb(source)) {
    std::uint8_t* const data[4] = {picture.rgb8.data(), nullptr, nullptr, nullptr};
    const int strides[4] = {static_cast<int>(3 * width), 0, 0, 0};
    return scale(source, AV_PIX_FMT_RGB24, data, strides);
  }
  if ((layout->flags & (AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BAYER)) != 0) return false;
  const bool palette = (layout->flags & AV_PIX_FMT_FLAG_PAL) != 0;
  line_.resize(width);
  const std::uint8_t* data[4] = {source.data[0], source.data[1], source.data[2], source.data[3]};
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* row = picture.rgb8.data() + 3 * width * y;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::size_t component = palette || layout->nb_components > 2 ? channel : 0;
      const std::uint32_t max_value = palette ? 255u : (1u << layout->comp[component].depth) - 1u;
      av_read_image_line2(line_.data(), data, source.linesize, layout, 0, static_cast<int>(y),
                          static_cast<int>(component), source.width, palette ? 1 : 0, sizeof(std::uint16_t));
      for (std::size_t x = 0; x < width; ++x) {
        row[3 * x + channel] = static_cast<std::uint8_t>((line_[x] * 255u + max_value / 2) / max_value);
      }
    }
  }
  return true;
}

bool FrameConverter::scale(const AVFrame& source, AVPixelFormat target, std::uint8_t* const data[],
                           const int stride[]) {
  const auto format = static_cast<AVPixelFormat>(source.format);
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(format);
  if (layout == nullptr || sws_isSupportedInput(format) == 0) return false;
  if (scaler_ == nullptr || scaler_source_ != format || scaler_width_ != source.width ||
      scaler_height_ != source.height) {
    scaler_.reset(sws_alloc_context());
    SwsContext* s = scaler_.get();
    if (s == nullptr) return false;
    av_opt_set_int(s, "srcw", source.width, 0);
    av_opt_set_int(s, "srch", source.height, 0);
    av_opt_set_int(s, "dstw", source.width, 0);
    av_opt_set_int(s, "dsth", source.height, 0);
    av_opt_set_int(s, "src_format", format, 0);
    av_opt_set_int(s, "dst_format", target, 0);
    av_opt_set_int(s, "sws_flags", kScalerFlags, 0);
    set_chroma_position(s, source, *layout);
    const int* matrix = matrix_of(source);
    const bool to_rgb = (av_pix_fmt_desc_get(target)->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    const int range = full_range(source) ? 1 : 0;
    // RGB is full-range by definition. From YUV to YUV limited range can become full range, but not the reverse.
    const bool to_full_range = to_rgb || color_space(format_) == ColorSpace::kYuvFullRange;
    sws_setColorspaceDetails(s, matrix, range, matrix, to_full_range ? 1 : range, 0, 1 << 16, 1 << 16);
    if (sws_init_context(s, nullptr, nullptr) < 0) {
      scaler_.reset();
      return false;
    }
    scaler_source_ = format;
    scaler_width_ = source.width;
    scaler_height_ = source.height;
  }
  const int rows = sws_scale(scaler_.get(), source.data, source.linesize, 0, source.height, data, stride);
  return rows == source.height;
}

bool FrameConverter::to_yuv(const AVFrame& source, SourceFrame& out) {
  const std::size_t width = out.view.width_px, height = out.view.height_px, half = (width + 1) / 2;
  const bool has_420 = info_of(format_).channel[1].shift_v == 1;
  const auto layout = static_cast<AVPixelFormat>(source.format);
  const bool stored_420 = layout == AV_PIX_FMT_YUV420P || layout == AV_PIX_FMT_YUVJ420P;
  const bool stored_422 = layout == AV_PIX_FMT_YUV422P || layout == AV_PIX_FMT_YUVJ422P;
  const bool keeps_range = color_space(format_) != ColorSpace::kYuvFullRange || full_range(source);

  struct Planes {
    const std::uint8_t* data[3];
    int stride[3];
    int chroma_shift;  // log2 of the number of picture rows per row of chroma
  };
  Planes planes{};
  if (keeps_range && (stored_420 || (stored_422 && !has_420))) {
    for (std::size_t i = 0; i < 3; ++i) {
      planes.data[i] = source.data[i];
      planes.stride[i] = source.linesize[i];
    }
    planes.chroma_shift = stored_420 ? 1 : 0;
  } else {
    const std::size_t chroma_rows = has_420 ? (height + 1) / 2 : height;
    planar_.resize(width * height + 2 * half * chroma_rows + AV_INPUT_BUFFER_PADDING_SIZE);
    std::uint8_t* const data[4] = {planar_.data(), planar_.data() + width * height,
                                   planar_.data() + width * height + half * chroma_rows, nullptr};
    const int strides[4] = {static_cast<int>(width), static_cast<int>(half), static_cast<int>(half), 0};
    if (!scale(source, has_420 ? AV_PIX_FMT_YUV420P : AV_PIX_FMT_YUV422P, data, strides)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      planes.data[i] = data[i];
      planes.stride[i] = strides[i];
    }
    planes.chroma_shift = has_420 ? 1 : 0;
  }

  const auto row_of = [&planes](std::size_t plane, std::size_t row) {
    return planes.data[plane] + static_cast<std::ptrdiff_t>(row) * planes.stride[plane];
  };
  // In packed formats the last pair of an odd width repeats the luma of its only pixel.
  const std::size_t luma_samples = row_bytes(format_, 0, width) / info_of(format_).channel[0].step;
  for (std::size_t y = 0; y < height; ++y) {
    out.write_row(0, y, luma_samples,
                  [row = row_of(0, y), width](std::size_t x) { return row[std::min(x, width - 1)]; });
    for (std::size_t c = 1; c < 3; ++c) {
      if (has_420 && y % 2 == 1) continue;
      out.write_row(c, y, half, [row = row_of(c, y >> planes.chroma_shift)](std::size_t x) { return row[x]; });
    }
  }
  return true;
}

}  // namespace touchline::hal::ffmpeg
