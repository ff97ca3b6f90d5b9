#include "hal/linux/v4l2/mjpg_decoder.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <vector>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

#include <jerror.h>

namespace touchline::hal {
namespace {

// Alignment of rows for the library's vector instructions, which may read up to this many bytes beyond the end.
constexpr std::size_t kAlignment = 64;
// libjpeg-turbo 2.1 needs 13 KiB for pictures of any size: it writes the samples into the planes.
constexpr std::size_t kLibraryBytes = std::size_t{64} * 1024;

constexpr std::size_t rounded_up(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

// Largest number of rows of a component that the library decodes at a time: blocks of eight rows, of which JPEG allows
// four.
constexpr std::size_t kMaxRowsAtOnce = std::size_t{MAX_SAMP_FACTOR} * DCTSIZE;
constexpr std::uint8_t kNoChroma = 128;
constexpr PixelFormat kDecodedFormat = PixelFormat::kYuvj422p;

}  // namespace

/// libjpeg's object, with callbacks for memory and for errors. Errors leave the library by longjmp().
struct MjpgDecoder::Library {
  Library(std::uint16_t width, std::uint16_t height);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// A component of the picture (Y, U or V) and the plane for its samples.
  struct Component {
    std::uint8_t* plane = nullptr;
    std::size_t stride_bytes = 0;
    std::size_t samples = 0;                                 // number of samples in a row of the plane
    std::size_t pixels_per_sample = 1, rows_per_sample = 1;  // as stored in the JPEG
    std::size_t rows = DCTSIZE;                              // rows that the library decodes at a time
    bool is_resampled = false;  // the plane's rows have more or fewer samples than the JPEG's

    [[nodiscard]] std::uint8_t* row(std::size_t v) const { return plane + v * stride_bytes; }
    /// Writes a row of the plane from a row of the JPEG, in which a sample belongs to one pixel or to four.
    void resample(const std::uint8_t* from, std::size_t v, std::size_t pixels) const {
      std::uint8_t* const to = row(v);
      if (pixels_per_sample == 4) {
        for (std::size_t i = 0; i < samples; ++i) to[i] = from[i / 2];
        return;
      }
      for (std::size_t i = 0; i < pixels / 2; ++i)
        to[i] = static_cast<std::uint8_t>((from[2 * i] + from[2 * i + 1] + 1) / 2);
      if (pixels % 2 == 1) to[samples - 1] = from[pixels - 1];
    }
  };

  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_memory_mgr memory{};
  jpeg_memory_mgr* own_memory = nullptr;  // the library's memory manager, used when jpeg is created and destroyed
  std::jmp_buf escape{};
  std::array<char, JMSG_LENGTH_MAX> error_text{};
  const std::uint16_t width_px, height_px;
  // Permanent memory is allocated from the front, memory of one picture from the back.
  std::vector<std::byte> block;
  std::byte* begin = nullptr;
  std::size_t size = 0, front = 0, back = 0;
  bool has_ended = false;  // the data ended before the EOI marker
  std::array<Component, kMaxPlanes> component;
  // Rows of U and V before resampling, and a row for samples below the last row of the picture.
  std::vector<std::uint8_t> spare_rows;

  template <class Any>
  static Library& of(Any* jpeg) {
    return *static_cast<Library*>(jpeg->client_data);
  }

  [[noreturn]] void fail() { std::longjmp(escape, 1); }  // NOLINT(cert-err52-cpp): through a library in C
  [[noreturn]] void fail(const char* why) {
    std::snprintf(error_text.data(), error_text.size(), "%s", why);
    fail();
  }

  void* allocate(int pool, std::size_t bytes) {
    const std::size_t wanted = rounded_up(bytes);
    if (wanted > back - front) fail("needs more memory than expected");
    if (pool == JPOOL_PERMANENT) {
      front += wanted;
      return begin + front - wanted;
    }
    back -= wanted;
    return begin + back;
  }
  template <class Element>
  Element** allocate_rows(int pool, std::size_t per_row, std::size_t rows) {
    const std::size_t row_bytes = rounded_up(per_row * sizeof(Element));
    auto* const list = static_cast<Element**>(allocate(pool, rows * sizeof(Element*)));
    auto* const elements = static_cast<std::byte*>(allocate(pool, rows * row_bytes));
    for (std::size_t i = 0; i < rows; ++i) list[i] = reinterpret_cast<Element*>(elements + i * row_bytes);
    return list;
  }

  /// Resets the tables, because a picture without tables must use the standard ones, not those of the previous picture.
  void reset_tables() {
    std::fill(std::begin(jpeg.quant_tbl_ptrs), std::end(jpeg.quant_tbl_ptrs), nullptr);
    std::fill(std::begin(jpeg.dc_huff_tbl_ptrs), std::end(jpeg.dc_huff_tbl_ptrs), nullptr);
    std::fill(std::begin(jpeg.ac_huff_tbl_ptrs), std::end(jpeg.ac_huff_tbl_ptrs), nullptr);
    jpeg.src = nullptr;
    front = 0;
  }
  void install_error_handlers();
  void install_memory_manager();

  [[nodiscard]] std::size_t row_bytes_of_library() const { return rounded_up(width_px); }
  [[nodiscard]] std::uint8_t* unused_row() { return spare_rows.data(); }
  [[nodiscard]] std::uint8_t* chroma_row(std::size_t c, std::size_t row) {
    return spare_rows.data() + (1 + (c - 1) * kMaxRowsAtOnce + row) * row_bytes_of_library();
  }
  void read_header(std::span<const std::uint8_t> bytes);
  void describe_components(const PictureLayout& layout, std::uint8_t* picture);
  void decode_rows();
};

MjpgDecoder::Library::Library(std::uint16_t width, std::uint16_t height) : width_px(width), height_px(height) {
  size = back = kLibraryBytes;
  block.resize(size + kAlignment);
  begin = block.data() + kAlignment - reinterpret_cast<std::uintptr_t>(block.data()) % kAlignment;
  spare_rows.resize((1 + 2 * kMaxRowsAtOnce) * row_bytes_of_library());
  jpeg.err = jpeg_std_error(&errors);
  jpeg.client_data = this;
  jpeg_create_decompress(&jpeg);
  install_error_handlers();
  install_memory_manager();
}

MjpgDecoder::Library::~Library() {
  jpeg.mem = own_memory;
  jpeg_destroy_decompress(&jpeg);
}

void MjpgDecoder::Library::install_error_handlers() {
  errors.error_exit = [](j_common_ptr any) {
    any->err->format_message(any, of(any).error_text.data());
    of(any).fail();
  };
  errors.emit_message = [](j_common_ptr any, int level) {
    if (level >= 0) return;  // information, not a warning
    const int code = any->err->msg_code;
    Library& library = of(any);
    // These warnings do not affect the picture: another version of the header, a few bytes before a marker, no EOI
    // marker. If more is missing, the decoder warns about missing bits. Surplus bytes before an end without EOI mean
    // that the picture was cut off and padded.
    if (code == JWRN_JFIF_MAJOR || (code == JWRN_EXTRANEOUS_DATA && !library.has_ended)) return;
    if (code == JWRN_JPEG_EOF) {
      library.has_ended = true;
      return;
    }
    any->err->error_exit(any);
  };
}

void MjpgDecoder::Library::install_memory_manager() {
  own_memory = jpeg.mem;
  memory = *own_memory;
  jpeg.mem = &memory;
  memory.alloc_small = [](j_common_ptr any, int pool, std::size_t bytes) { return of(any).allocate(pool, bytes); };
  memory.alloc_large = memory.alloc_small;
  memory.alloc_sarray = [](j_common_ptr any, int pool, JDIMENSION samples, JDIMENSION rows) {
    return of(any).allocate_rows<JSAMPLE>(pool, samples, rows);
  };
  memory.alloc_barray = [](j_common_ptr any, int pool, JDIMENSION blocks, JDIMENSION rows) {
    return of(any).allocate_rows<JBLOCK>(pool, blocks, rows);
  };
  memory.free_pool = [](j_common_ptr any, int pool) {
    if (pool == JPOOL_IMAGE) of(any).back = of(any).size;
  };
  // Do not allocate arrays for the coefficients of a whole picture; decode() rejects pictures that need them.
  memory.realize_virt_arrays = [](j_common_ptr) {};
  memory.request_virt_sarray = [](j_common_ptr any, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_sarray_ptr { of(any).fail("needs the whole picture at once"); };
  memory.request_virt_barray = [](j_common_ptr any, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_barray_ptr { of(any).fail("needs the whole picture at once"); };
}

void MjpgDecoder::Library::read_header(std::span<const std::uint8_t> bytes) {
  reset_tables();
  has_ended = false;
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  if (jpeg.image_width != width_px || jpeg.image_height != height_px) {
    std::snprintf(error_text.data(), error_text.size(), "its size is %ux%u", jpeg.image_width, jpeg.image_height);
    fail();
  }
  // Newer versions of libjpeg also decode samples of more than 8 bits, whose rows have another size.
  if (jpeg.data_precision != 8 || jpeg.progressive_mode != FALSE || jpeg_has_multiple_scans(&jpeg) != FALSE) {
    fail("not a baseline JPEG with one scan");
  }
  const bool is_gray = jpeg.jpeg_color_space == JCS_GRAYSCALE && jpeg.num_components == 1;
  if (!is_gray && (jpeg.jpeg_color_space != JCS_YCbCr || jpeg.num_components != 3)) fail("its colors are not YUV");
}

/// Fails if the JPEG has fewer luma samples than pixels, or if three pixels share a chroma sample. No camera sends such
/// pictures.
void MjpgDecoder::Library::describe_components(const PictureLayout& layout, std::uint8_t* picture) {
  for (std::size_t c = 0; c < component.size(); ++c) {
    Component& out = component[c];
    out = {.plane = picture + layout.offset_bytes[c], .stride_bytes = layout.stride_bytes[c]};
    out.samples = row_bytes(kDecodedFormat, c, width_px);
    if (c >= static_cast<std::size_t>(jpeg.num_components)) continue;
    const jpeg_component_info& info = jpeg.comp_info[c];
    const std::size_t across = static_cast<std::size_t>(jpeg.max_h_samp_factor),
                      down = static_cast<std::size_t>(jpeg.max_v_samp_factor),
                      h = static_cast<std::size_t>(info.h_samp_factor),
                      v = static_cast<std::size_t>(info.v_samp_factor);
    out.pixels_per_sample = across / h;
    out.rows_per_sample = down / v;
    out.rows = v * DCTSIZE;
    const bool is_whole = across % h == 0 && down % v == 0 && out.pixels_per_sample != 3;
    if (!is_whole || (c == 0 && (h != across || v != down))) fail("its numbers of luma and chroma samples are unusual");
    out.is_resampled = c > 0 && out.pixels_per_sample != 2;
  }
}

void MjpgDecoder::Library::decode_rows() {
  const auto components = static_cast<std::size_t>(jpeg.num_components);
  std::array<std::array<JSAMPROW, kMaxRowsAtOnce>, kMaxPlanes> pointers{};
  std::array<JSAMPARRAY, kMaxPlanes> of_component{};
  for (std::size_t c = 0; c < components; ++c) of_component[c] = pointers[c].data();
  for (std::size_t first = 0; first < height_px; first += component[0].rows) {
    for (std::size_t c = 0; c < components; ++c) {
      const Component& out = component[c];
      for (std::size_t i = 0; i < out.rows; ++i) {
        const std::size_t v = first + i * out.rows_per_sample;
        pointers[c][i] = v >= height_px ? unused_row() : out.is_resampled ? chroma_row(c, i) : out.row(v);
      }
    }
    jpeg_read_raw_data(&jpeg, of_component.data(), static_cast<JDIMENSION>(component[0].rows));
    for (std::size_t c = 1; c < components; ++c) {
      const Component& out = component[c];
      for (std::size_t i = 0; i < out.rows; ++i) {
        const std::size_t v = first + i * out.rows_per_sample;
        if (v >= height_px) break;
        if (out.is_resampled) out.resample(chroma_row(c, i), v, width_px);
        const std::size_t end = std::min<std::size_t>(v + out.rows_per_sample, height_px);
        for (std::size_t copy = v + 1; copy < end; ++copy) std::memcpy(out.row(copy), out.row(v), out.samples);
      }
    }
  }
  for (std::size_t c = components; c < component.size(); ++c) {
    std::memset(component[c].plane, kNoChroma, height_px * component[c].stride_bytes);
  }
}

MjpgDecoder::MjpgDecoder() = default;
MjpgDecoder::~MjpgDecoder() = default;

void MjpgDecoder::open(std::uint16_t width_px, std::uint16_t height_px) {
  library_ = std::make_unique<Library>(width_px, height_px);
  // The library writes whole blocks of eight columns.
  layout_ = picture_layout(kDecodedFormat, width_px, height_px, kAlignment);
}

Result<void> MjpgDecoder::decode(std::span<const std::uint8_t> bytes, std::uint8_t* picture) {
  Library& library = *library_;
  jpeg_decompress_struct& jpeg = library.jpeg;
  if (setjmp(library.escape) != 0) {  // NOLINT(cert-err52-cpp)
    jpeg_abort_decompress(&jpeg);
    return failure(ErrorCode::kCorruptFrame, "%s", library.error_text.data());
  }
  library.read_header(bytes);
  library.describe_components(layout_, picture);
  jpeg.raw_data_out = TRUE;
  jpeg.out_color_space = jpeg.jpeg_color_space;
  jpeg.dct_method = JDCT_ISLOW;  // the exact DCT, which with vector instructions is as fast as the others
  jpeg.do_fancy_upsampling = FALSE;
  jpeg_start_decompress(&jpeg);
  library.decode_rows();
  jpeg_finish_decompress(&jpeg);
  return {};
}

}  // namespace touchline::hal
