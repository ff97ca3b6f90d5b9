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

constexpr std::size_t kRowAlignmentBytes = 4;
std::size_t aligned(std::size_t bytes) {
  return (bytes + kRowAlignmentBytes - 1) / kRowAlignmentBytes * kRowAlignmentBytes;
}

/// Writes the samples of a channel that belong to row y of the picture; `sample_at(i)` returns sample i.
template <class SampleAt>
void write_channel(ConvertedFrame& out, std::size_t channel, std::size_t y, std::size_t samples, SampleAt sample_at) {
  const ChannelLayout& layout = info_of(out.view.format).channel[channel];
  const std::size_t plane_begin = static_cast<std::size_t>(out.view.plane[layout.plane] - out.bytes.data());
  std::uint8_t* const row =
      out.bytes.data() + plane_begin + (y >> layout.shift_v) * out.view.stride_bytes[layout.plane] + layout.offset;
  for (std::size_t i = 0; i < samples; ++i) row[i * layout.step] = sample_at(i);
}

}  // namespace

bool stored_as_rgb(const AVFrame& source) {
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(source.format));
  return layout != nullptr &&
         ((layout->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) != 0 || layout->nb_components <= 2);
}

template <class Sample>
bool read_rgb(const AVFrame& source, std::vector<std::uint16_t>& line, Sample* samples, std::size_t stride_samples) {
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(source.format));
  if (layout == nullptr || !stored_as_rgb(source)) return false;
  if ((layout->flags & (AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BAYER)) != 0) return false;
  const auto width = static_cast<std::size_t>(source.width);
  const auto height = static_cast<std::size_t>(source.height);
  constexpr std::uint32_t kMaxValue = sizeof(Sample) == 1 ? 255 : 65535;
  const bool palette = (layout->flags & AV_PIX_FMT_FLAG_PAL) != 0;
  if (sizeof(Sample) == 1 && source.format == AV_PIX_FMT_RGB24) {
    for (std::size_t y = 0; y < height; ++y) {
      const std::uint8_t* row = source.data[0] + static_cast<std::ptrdiff_t>(y) * source.linesize[0];
      std::copy_n(row, 3 * width, samples + y * stride_samples);
    }
    return true;
  }
  line.resize(width);
  const std::uint8_t* data[4] = {source.data[0], source.data[1], source.data[2], source.data[3]};
  for (std::size_t y = 0; y < height; ++y) {
    Sample* row = samples + y * stride_samples;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::size_t component = palette || layout->nb_components > 2 ? channel : 0;
      const std::uint32_t max_value = palette ? 255u : (1u << layout->comp[component].depth) - 1u;
      av_read_image_line2(line.data(), data, source.linesize, layout, 0, static_cast<int>(y),
                          static_cast<int>(component), source.width, palette ? 1 : 0, sizeof(std::uint16_t));
      for (std::size_t x = 0; x < width; ++x) {
        row[3 * x + channel] = static_cast<Sample>((line[x] * kMaxValue + max_value / 2) / max_value);
      }
    }
  }
  return true;
}
template bool read_rgb(const AVFrame&, std::vector<std::uint16_t>&, std::uint8_t*, std::size_t);
template bool read_rgb(const AVFrame&, std::vector<std::uint16_t>&, std::uint16_t*, std::size_t);

Result<void> FrameConverter::convert(const AVFrame& source, ConvertedFrame& out) {
  const auto unsupported = [] {
    return failure(ErrorCode::kUnsupported, "cannot be converted to the requested format");
  };
  if (source.width < 1 || source.height < 1 || source.width > static_cast<int>(kMaxFrameWidth) ||
      source.height > static_cast<int>(kMaxFrameHeight)) {
    return unsupported();
  }
  out.view.format = format_;
  out.view.width_px = static_cast<std::uint16_t>(source.width);
  out.view.height_px = static_cast<std::uint16_t>(source.height);
  const PictureLayout layout = picture_layout(format_, out.view.width_px, out.view.height_px, kRowAlignmentBytes);
  out.bytes.resize(layout.bytes + AV_INPUT_BUFFER_PADDING_SIZE);
  out.view.plane = {};
  out.view.stride_bytes = layout.stride_bytes;
  for (std::size_t i = 0; i < info_of(format_).planes; ++i)
    out.view.plane[i] = out.bytes.data() + layout.offset_bytes[i];
  const bool converted = color_space(format_) == ColorSpace::kRgb ? to_rgb(source, out) : to_yuv(source, out);
  if (!converted) return unsupported();
  return {};
}

bool FrameConverter::scale(const AVFrame& source, AVPixelFormat target, std::uint8_t* const data[],
                           const int stride[]) {
  const auto format = static_cast<AVPixelFormat>(source.format);
  const AVPixFmtDescriptor* layout = av_pix_fmt_desc_get(format);
  if (layout == nullptr || sws_isSupportedInput(format) == 0) return false;
  if (scaler_ == nullptr || scaler_source_ != format || scaler_target_ != target || scaler_width_ != source.width ||
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
    const bool from_rgb = stored_as_rgb(source);
    const int* matrix = from_rgb ? sws_getCoefficients(SWS_CS_ITU601) : matrix_of(source);
    const bool to_rgb = (av_pix_fmt_desc_get(target)->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    const int range = full_range(source) ? 1 : 0;
    // RGB is full-range by definition. From YUV to YUV limited range can become full range, but not the reverse.
    const bool to_full_range = to_rgb || color_space(format_) == ColorSpace::kYuvFullRange;
    sws_setColorspaceDetails(s, matrix, from_rgb ? 1 : range, matrix, to_full_range ? 1 : (from_rgb ? 0 : range), 0,
                             1 << 16, 1 << 16);
    if (sws_init_context(s, nullptr, nullptr) < 0) {
      scaler_.reset();
      return false;
    }
    scaler_source_ = format;
    scaler_target_ = target;
    scaler_width_ = source.width;
    scaler_height_ = source.height;
  }
  const int rows = sws_scale(scaler_.get(), source.data, source.linesize, 0, source.height, data, stride);
  return rows == source.height;
}

bool FrameConverter::read_as_rgb(const AVFrame& source, std::size_t stride_bytes) {
  rgb_.resize(stride_bytes * static_cast<std::size_t>(source.height) + AV_INPUT_BUFFER_PADDING_SIZE);
  return read_rgb(source, line_, rgb_.data(), stride_bytes);
}

bool FrameConverter::to_rgb(const AVFrame& source, ConvertedFrame& out) {
  const std::size_t width = out.view.width_px, height = out.view.height_px, stride = aligned(3 * width);
  if (stored_as_rgb(source)) {
    if (!read_as_rgb(source, stride)) return false;
  } else {
    rgb_.resize(stride * height + AV_INPUT_BUFFER_PADDING_SIZE);
    std::uint8_t* const data[4] = {rgb_.data(), nullptr, nullptr, nullptr};
    const int strides[4] = {static_cast<int>(stride), 0, 0, 0};
    if (!scale(source, AV_PIX_FMT_RGB24, data, strides)) return false;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t y = 0; y < height; ++y) {
      write_channel(out, c, y, width, [row = rgb_.data() + y * stride + c](std::size_t x) { return row[3 * x]; });
    }
  }
  return true;
}

bool FrameConverter::to_yuv(const AVFrame& source, ConvertedFrame& out) {
  const std::size_t width = out.view.width_px, height = out.view.height_px, half = (width + 1) / 2;
  const bool has_420 = info_of(format_).channel[1].shift_v == 1;
  const auto layout = static_cast<AVPixelFormat>(source.format);
  const bool stored_420 = layout == AV_PIX_FMT_YUV420P || layout == AV_PIX_FMT_YUVJ420P;
  const bool stored_422 = layout == AV_PIX_FMT_YUV422P || layout == AV_PIX_FMT_YUVJ422P;
  const bool keeps_range = color_space(format_) != ColorSpace::kYuvFullRange || full_range(source);

  Planes planes{};
  if (keeps_range && (stored_420 || (stored_422 && !has_420))) {
    for (std::size_t i = 0; i < 3; ++i) {
      planes.data[i] = source.data[i];
      planes.stride[i] = source.linesize[i];
    }
    planes.chroma_shift = stored_420 ? 1 : 0;
  } else {
    const AVFrame* input = &source;
    AVFrame rgb{};
    if (stored_as_rgb(source)) {
      if (!read_as_rgb(source, 3 * width)) return false;
      rgb.format = AV_PIX_FMT_RGB24;
      rgb.width = source.width;
      rgb.height = source.height;
      rgb.data[0] = rgb_.data();
      rgb.linesize[0] = static_cast<int>(3 * width);
      input = &rgb;
    }
    const std::size_t chroma_rows = has_420 ? (height + 1) / 2 : height;
    planar_.resize(width * height + 2 * half * chroma_rows + AV_INPUT_BUFFER_PADDING_SIZE);
    std::uint8_t* const data[4] = {planar_.data(), planar_.data() + width * height,
                                   planar_.data() + width * height + half * chroma_rows, nullptr};
    const int strides[4] = {static_cast<int>(width), static_cast<int>(half), static_cast<int>(half), 0};
    if (!scale(*input, has_420 ? AV_PIX_FMT_YUV420P : AV_PIX_FMT_YUV422P, data, strides)) return false;
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
    write_channel(out, 0, y, luma_samples,
                  [row = row_of(0, y), width](std::size_t x) { return row[std::min(x, width - 1)]; });
    for (std::size_t c = 1; c < 3; ++c) {
      if (has_420 && y % 2 == 1) continue;
      write_channel(out, c, y, half, [row = row_of(c, y >> planes.chroma_shift)](std::size_t x) { return row[x]; });
    }
  }
  return true;
}

}  // namespace touchline::hal::ffmpeg
