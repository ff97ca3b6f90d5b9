#include "hal/linux/v4l2/mjpg_decoder.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <vector>

// Included after <cstdio>, because libjpeg's header needs FILE.
#include <jpeglib.h>

#include <jerror.h>

namespace touchline::hal {
namespace {

// Alignment of rows for the library's vector instructions, which may read up to this many bytes beyond the end.
constexpr std::size_t kAlignment = 64;
// libjpeg-turbo 2.1 needs 20 KiB for tables and 40 bytes per column for its row buffers, with all chroma subsamplings
// of cameras.
constexpr std::size_t kTableBytes = std::size_t{64} * 1024;
constexpr std::size_t kBytesPerColumn = 128;

constexpr std::size_t rounded_up(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

/// libjpeg's object, with callbacks for memory and for errors. Errors leave the library by longjmp().
struct MjpgDecoder::Library {
  Library(std::uint16_t width, std::uint16_t height);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

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
    if (wanted > back - front) fail("needs more memory than expected for this size");
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

  /// A picture without tables must use the standard ones, not those of the previous picture.
  void reset_tables() {
    std::fill(std::begin(jpeg.quant_tbl_ptrs), std::end(jpeg.quant_tbl_ptrs), nullptr);
    std::fill(std::begin(jpeg.dc_huff_tbl_ptrs), std::end(jpeg.dc_huff_tbl_ptrs), nullptr);
    std::fill(std::begin(jpeg.ac_huff_tbl_ptrs), std::end(jpeg.ac_huff_tbl_ptrs), nullptr);
    jpeg.src = nullptr;
    front = 0;
  }
  void install_error_handlers();
  void install_memory_manager();
};

MjpgDecoder::Library::Library(std::uint16_t width, std::uint16_t height) : width_px(width), height_px(height) {
  size = back = kTableBytes + kBytesPerColumn * rounded_up(width);
  block.resize(size + kAlignment);
  begin = block.data() + kAlignment - reinterpret_cast<std::uintptr_t>(block.data()) % kAlignment;
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
  // Arrays for the coefficients of a whole picture; decode() refuses pictures that need them.
  memory.realize_virt_arrays = [](j_common_ptr) {};
  memory.request_virt_sarray = [](j_common_ptr any, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_sarray_ptr { of(any).fail("needs the whole picture at once"); };
  memory.request_virt_barray = [](j_common_ptr any, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_barray_ptr { of(any).fail("needs the whole picture at once"); };
}

MjpgDecoder::MjpgDecoder() = default;
MjpgDecoder::~MjpgDecoder() = default;

void MjpgDecoder::open(std::uint16_t width_px, std::uint16_t height_px) {
  library_ = std::make_unique<Library>(width_px, height_px);
}

Result<void> MjpgDecoder::decode(std::span<const std::uint8_t> bytes, std::uint8_t* rgb) {
  Library& library = *library_;
  jpeg_decompress_struct& jpeg = library.jpeg;
  if (setjmp(library.escape) != 0) {  // NOLINT(cert-err52-cpp)
    jpeg_abort_decompress(&jpeg);
    return failure(ErrorCode::kCorruptFrame, "%s", library.error_text.data());
  }
  library.reset_tables();
  library.has_ended = false;
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  if (jpeg.image_width != library.width_px || jpeg.image_height != library.height_px) {
    std::snprintf(library.error_text.data(), library.error_text.size(), "its size is %ux%u", jpeg.image_width,
                  jpeg.image_height);
    library.fail();
  }
  // Newer versions of libjpeg also decode samples of more than 8 bits, whose rows have another size.
  if (jpeg.data_precision != 8 || jpeg.progressive_mode != FALSE || jpeg_has_multiple_scans(&jpeg) != FALSE) {
    library.fail("not a baseline JPEG with one scan");
  }
  jpeg.out_color_space = JCS_RGB;
  jpeg.dct_method = JDCT_ISLOW;  // the exact DCT; as fast as the others with vector instructions
  jpeg.do_fancy_upsampling = FALSE;
  jpeg_start_decompress(&jpeg);
  const std::size_t stride = std::size_t{3} * library.width_px;
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = rgb + jpeg.output_scanline * stride;
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  return {};
}

}  // namespace touchline::hal
