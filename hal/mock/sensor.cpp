#include "hal/mock/sensor.h"

#include <algorithm>
#include <cmath>

#include "hal/mock/renderer.h"

namespace touchline::hal::mock {
namespace {

constexpr std::uint64_t kSensorStream = 3;

// Conversion from RGB by ITU-R BT.601, in 16-bit fixed point.
using RgbToYuv = std::array<std::array<int, 3>, 3>;
constexpr RgbToYuv kLimitedRange{{{16829, 33039, 6416}, {-9714, -19070, 28784}, {28784, -24103, -4681}}};
constexpr RgbToYuv kFullRange{{{19595, 38470, 7471}, {-11058, -21710, 32768}, {32768, -27439, -5329}}};

struct Yuv {
  int y, u, v;
};
Yuv to_yuv(const std::uint8_t* rgb, ColorSpace space) {
  const RgbToYuv& factors = space == ColorSpace::kYuv ? kLimitedRange : kFullRange;
  const auto channel = [&](std::size_t c) {
    const int sum = factors[c][0] * rgb[0] + factors[c][1] * rgb[1] + factors[c][2] * rgb[2];
    // Pure blue and red give 255.5 in full range.
    return std::min(255, ((sum + (1 << 15)) >> 16) + black_value(space, c));
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

Sensor::Sensor(const SensorParameters& parameters, PixelFormat format, std::uint16_t width_px, std::uint16_t height_px,
               std::uint64_t seed)
    : parameters_(parameters),
      format_(format),
      width_(width_px),
      height_(height_px),
      layout_(picture_layout(format, width_px, height_px)),
      random_(seed, kSensorStream),
      mean_(kLinearScale + 1),
      sigma_(kLinearScale + 1),
      tone_(kLinearScale + 1),
      row_(3 * width_),
      chroma_(2 * ((width_ + 1) / 2)) {
  for (std::size_t i = 0; i <= kLinearScale; ++i) {
    const double value = static_cast<double>(i) / kLinearScale;
    tone_[i] = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(value, 1.0 / parameters.gamma)));
  }
  if (parameters.blur_px > 0.0) blur_.emplace(parameters.blur_px, width_, height_);
  if (parameters.bayer != BayerPattern::kNone && width_ > 1 && height_ > 1) {
    bayer_.emplace(parameters.bayer, width_, height_);
    filtered_.resize(width_);
    measured_.resize(width_ * height_);
    interpolated_.resize(3 * width_);
  }
  set_brightness(1.0);
}

void Sensor::set_brightness(double brightness) {
  const double electrons_per_step = parameters_.full_well_electrons / kLinearScale;
  const double read_noise = parameters_.read_noise_electrons;
  for (std::size_t i = 0; i <= kLinearScale; ++i) {
    const double value = std::min(static_cast<double>(i) * brightness, double{kLinearScale});
    mean_[i] = static_cast<float>(value);
    sigma_[i] =
        static_cast<float>(std::sqrt(read_noise * read_noise + value * electrons_per_step) / electrons_per_step);
  }
}

void Sensor::expose(std::span<const std::uint16_t> linear, std::span<std::uint8_t> out) {
  if (blur_) linear = (*blur_)(linear);
  if (bayer_) measure_mosaic(linear.data());
  for (std::size_t row = 0; row < height_; ++row) {
    if (bayer_) {
      bayer_->interpolate_row(measured_, row, interpolated_);
      for (std::size_t i = 0; i < row_.size(); ++i)
        row_[i] = tone_[static_cast<std::size_t>(std::lround(interpolated_[i]))];
    } else {
      add_noise_and_gamma(&linear[3 * width_ * row]);
    }
    write_row(row, out);
  }
}

template <class Out>
void Sensor::add_noise(const std::uint16_t* linear, std::size_t count, Out out) {
  // Raw pointers, because builds with sanitizers call a function for each element of a vector: a million calls per
  // picture.
  const float* const mean = mean_.data();
  const float* const sigma = sigma_.data();
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 4 == 0) bits = random_.bits();
    const std::uint16_t value = linear[i];
    const float noisy =
        mean[value] + sigma[value] * normal_[bits] + 0.5f;  // + 0.5: the conversion to an index truncates
    bits >>= 16U;
    out(i, std::clamp(noisy, 0.0f, static_cast<float>(kLinearScale)));
  }
}

void Sensor::add_noise_and_gamma(const std::uint16_t* linear) {
  const std::uint8_t* const tone = tone_.data();
  std::uint8_t* const out = row_.data();
  add_noise(linear, row_.size(), [=](std::size_t i, float noisy) { out[i] = tone[static_cast<std::size_t>(noisy)]; });
}

void Sensor::measure_mosaic(const std::uint16_t* linear) {
  for (std::size_t row = 0; row < height_; ++row) {
    const std::uint16_t* const pixels = linear + 3 * width_ * row;
    for (std::size_t column = 0; column < width_; ++column) {
      filtered_[column] = pixels[3 * column + bayer_->color_at(column, row)];
    }
    float* const out = &measured_[width_ * row];
    add_noise(filtered_.data(), width_, [=](std::size_t i, float noisy) { out[i] = std::max(noisy - 0.5f, 0.0f); });
  }
}

void Sensor::write_row(std::size_t row, std::span<std::uint8_t> out) {
  if (color_space(format_) == ColorSpace::kRgb) {
    write_rgb_row(row, out);
  } else {
    write_yuv_row(row, out);
  }
}

std::uint8_t* Sensor::channel_row(std::size_t channel, std::size_t row, std::span<std::uint8_t> out) const {
  const ChannelLayout& layout = info_of(format_).channel[channel];
  return out.data() + layout_.offset_bytes[layout.plane] +
         (row >> layout.shift_v) * layout_.stride_bytes[layout.plane] + layout.offset;
}

void Sensor::write_rgb_row(std::size_t row, std::span<std::uint8_t> out) {
  const std::size_t step = info_of(format_).channel[0].step;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::uint8_t* const to = channel_row(channel, row, out);
    const std::uint8_t* const from = row_.data() + channel;
    for (std::size_t column = 0; column < width_; ++column) to[column * step] = from[3 * column];
  }
}

void Sensor::write_yuv_row(std::size_t row, std::span<std::uint8_t> out) {
  const std::array<ChannelLayout, 3>& channel = info_of(format_).channel;
  // Pixels 2 * k and 2 * k + 1 share chroma, in 4:2:0 with those of the next row. An odd width repeats the last pixel.
  const std::size_t luma_samples = row_bytes(format_, 0, width_) / channel[0].step;
  const std::size_t rows_of_sample = std::size_t{1} << channel[1].shift_v;
  const bool begins_block = row % rows_of_sample == 0;
  const bool ends_block = (row + 1) % rows_of_sample == 0 || row + 1 == height_;
  const ColorSpace space = color_space(format_);
  std::uint8_t* const luma = channel_row(0, row, out);
  if (begins_block) std::fill(chroma_.begin(), chroma_.end(), std::uint16_t{0});
  for (std::size_t column = 0; column < width_; column += 2) {
    const Yuv a = to_yuv(&row_[3 * column], space);
    const Yuv b = column + 1 < width_ ? to_yuv(&row_[3 * column + 3], space) : a;
    luma[column * channel[0].step] = static_cast<std::uint8_t>(a.y);
    if (column + 1 < luma_samples) luma[(column + 1) * channel[0].step] = static_cast<std::uint8_t>(b.y);
    chroma_[column] = static_cast<std::uint16_t>(chroma_[column] + a.u + b.u);
    chroma_[column + 1] = static_cast<std::uint16_t>(chroma_[column + 1] + a.v + b.v);
  }
  if (!ends_block) return;
  const int count = static_cast<int>(2 * (row % rows_of_sample + 1));
  std::uint8_t* const to[] = {channel_row(1, row, out), channel_row(2, row, out)};
  for (std::size_t i = 0; i < chroma_.size(); ++i) {
    to[i % 2][i / 2 * channel[1].step] = static_cast<std::uint8_t>((chroma_[i] + count / 2) / count);
  }
}

}  // namespace touchline::hal::mock
