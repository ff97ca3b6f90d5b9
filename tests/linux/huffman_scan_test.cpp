#include "hal/linux/v4l2/huffman_scan.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/linux/jpeg_encoder.h"

namespace touchline::testing {
namespace {

using hal::HuffmanCode;
using hal::HuffmanScan;
using BlockList = std::vector<HuffmanScan::Block>;

constexpr unsigned kScanWidth = 136, kScanHeight = 64;
constexpr std::size_t kUnits = std::size_t{kScanWidth / 8} * (kScanHeight / 8);  // of three blocks

struct ScanStyle {
  int quality = 80;
  bool own_tables = false;
  unsigned units_between_restarts = 0;
};

// Without shared chroma, in blocks of noise and of one color.
std::vector<std::uint8_t> coded_blocks(const ScanStyle& style) {
  std::mt19937 random(3);
  const auto set_up = [&](jpeg_compress_struct& jpeg) {
    jpeg_set_quality(&jpeg, style.quality, TRUE);
    jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;
    jpeg.optimize_coding = style.own_tables ? TRUE : FALSE;
    jpeg.restart_interval = style.units_between_restarts;
  };
  return encode_jpeg(kScanWidth, kScanHeight, set_up, [&](unsigned v, std::span<std::uint8_t> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool is_noise = (i / 48 + v / 8) % 3 == 0;
      row[i] = static_cast<std::uint8_t>(is_noise ? random() : 40 * (v / 8) + 7 * (i / 24));
    }
  });
}

// A JPEG whose header and coefficients libjpeg has read.
class CodedReference {
 public:
  explicit CodedReference(const std::vector<std::uint8_t>& bytes) {
    jpeg_.err = jpeg_std_error(&errors_);
    jpeg_create_decompress(&jpeg_);
    jpeg_mem_src(&jpeg_, bytes.data(), bytes.size());
    jpeg_read_header(&jpeg_, TRUE);
    data.assign(jpeg_.src->next_input_byte, jpeg_.src->next_input_byte + jpeg_.src->bytes_in_buffer);
    jvirt_barray_ptr* const arrays = jpeg_read_coefficients(&jpeg_);
    blocks.resize(3 * kUnits);
    for (std::size_t c = 0; c < 3; ++c) {
      for (unsigned row = 0; row < kScanHeight / 8; ++row) {
        JBLOCKARRAY const from =
            jpeg_.mem->access_virt_barray(reinterpret_cast<j_common_ptr>(&jpeg_), arrays[c], row, 1, FALSE);
        for (std::size_t column = 0; column < kScanWidth / 8; ++column) {
          HuffmanScan::Block& block = blocks[3 * (row * std::size_t{kScanWidth / 8} + column) + c];
          std::copy_n(&from[0][column][0], block.size(), block.begin());
        }
      }
    }
  }
  ~CodedReference() { jpeg_destroy_decompress(&jpeg_); }
  CodedReference(const CodedReference&) = delete;
  CodedReference& operator=(const CodedReference&) = delete;

  [[nodiscard]] bool set(std::array<HuffmanCode, 2>& first, std::array<HuffmanCode, 2>& others) const {
    bool is_set = true;
    for (std::size_t i = 0; i < 2; ++i) {
      const JHUFF_TBL &dc = *jpeg_.dc_huff_tbl_ptrs[i], &ac = *jpeg_.ac_huff_tbl_ptrs[i];
      is_set = is_set && first[i].set(HuffmanCode::Kind::kFirst, dc.bits, dc.huffval) &&
               others[i].set(HuffmanCode::Kind::kOthers, ac.bits, ac.huffval);
    }
    return is_set;
  }

  std::vector<std::uint8_t> data;  // of the scan
  BlockList blocks;

 private:
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
};

// The blocks until the first one that is refused.
BlockList read_scan(const CodedReference& reference, std::span<const std::uint8_t> data,
                    unsigned units_between_restarts, bool& is_complete) {
  std::array<HuffmanCode, 2> first, others;
  EXPECT_TRUE(reference.set(first, others));
  HuffmanScan scan;
  scan.open(100'000);
  BlockList blocks;
  is_complete = false;
  if (!scan.begin(data)) return blocks;
  std::array<std::uint32_t, 3> value{};
  for (std::size_t unit = 0; unit < kUnits; ++unit) {
    if (units_between_restarts > 0 && unit > 0 && unit % units_between_restarts == 0) {
      if (!scan.restart()) return blocks;
      value = {};
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t table = c == 0 ? 0 : 1;
      HuffmanScan::Block block{};
      if (scan.read_block(first[table], others[table], value[c], block) < 0) return blocks;
      blocks.push_back(block);
    }
  }
  is_complete = scan.is_complete();
  return blocks;
}

TEST(HuffmanScanTest, CoefficientsAreThoseThatLibjpegReads) {
  for (const int quality : {3, 30, 80, 100}) {
    for (const bool own_tables : {false, true}) {
      for (const unsigned units : {0u, 1u, 17u, 19u}) {
        const CodedReference reference(coded_blocks({quality, own_tables, units}));
        bool is_complete = false;
        EXPECT_EQ(read_scan(reference, reference.data, units, is_complete), reference.blocks)
            << quality << own_tables << units;
        EXPECT_TRUE(is_complete);
      }
    }
  }
}

TEST(HuffmanScanTest, DataThatEndEarlyAreRefused) {
  for (const unsigned units : {0u, 5u}) {
    const CodedReference reference(coded_blocks({.units_between_restarts = units}));
    bool is_complete = true;
    for (std::size_t bytes = reference.data.size() - 1; bytes > 0; bytes -= std::min<std::size_t>(bytes, 7)) {
      std::vector<std::uint8_t> data(reference.data.begin(),
                                     reference.data.begin() + static_cast<std::ptrdiff_t>(bytes));
      static_cast<void>(read_scan(reference, data, units, is_complete));
      EXPECT_FALSE(is_complete) << bytes;
      if (bytes + 10 > reference.data.size()) continue;  // what is missing may be unused bits
      data.insert(data.end(), {0xff, 0xd9});
      static_cast<void>(read_scan(reference, data, units, is_complete));
      EXPECT_FALSE(is_complete) << bytes << " bytes and an end marker";
    }
  }
}

TEST(HuffmanScanTest, OtherBytesMayPrecedeTheEnd) {
  const CodedReference reference(coded_blocks({}));
  std::vector<std::uint8_t> data = reference.data;
  data.insert(data.end() - 2, {0x00, 0x12, 0xff, 0x00, 0xff, 0xff});
  bool is_complete = false;
  EXPECT_EQ(read_scan(reference, data, 0, is_complete), reference.blocks);
  EXPECT_TRUE(is_complete);
  data.insert(data.end() - 2, {0xff, 0xd8});  // the start of another picture
  static_cast<void>(read_scan(reference, data, 0, is_complete));
  EXPECT_FALSE(is_complete);
}

TEST(HuffmanScanTest, WrongRestartMarkersAndLongSegmentsAreRefused) {
  const CodedReference reference(coded_blocks({.units_between_restarts = 5}));
  std::vector<std::uint8_t> data = reference.data;
  for (std::size_t i = 0; i + 1 < data.size(); ++i) {
    if (data[i] != 0xff || data[i + 1] != 0xd1) continue;
    data[i + 1] = 0xd2;
    break;
  }
  bool is_complete = true;
  EXPECT_EQ(read_scan(reference, data, 5, is_complete).size(), 3u * 10u);
  EXPECT_FALSE(is_complete);
  HuffmanScan scan;
  scan.open(100);
  EXPECT_FALSE(scan.begin(CodedReference(coded_blocks({})).data));
  EXPECT_FALSE(scan.begin({}));
}

TEST(HuffmanScanTest, RandomDataAreReadWithoutAccessesOutOfBounds) {
  const CodedReference reference(coded_blocks({}));
  std::mt19937 random(8);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::uint8_t> data(random() % 4000);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random() % 255);
    data.insert(data.end(), {0xff, 0xd9});
    bool is_complete = false;
    static_cast<void>(read_scan(reference, data, 0, is_complete));
  }
}

TEST(HuffmanCodeTest, WhatIsNoPrefixCodeIsRefused) {
  std::array<std::uint8_t, 17> counts{};
  std::array<std::uint8_t, 256> symbols{};
  counts[1] = 1;
  counts[3] = 4;
  HuffmanCode code;
  EXPECT_TRUE(code.set(HuffmanCode::Kind::kFirst, counts, symbols));
  counts[3] = 5;
  EXPECT_FALSE(code.set(HuffmanCode::Kind::kFirst, counts, symbols));
  counts[3] = 2;
  symbols[2] = 16;
  EXPECT_FALSE(code.set(HuffmanCode::Kind::kFirst, counts, symbols)) << "a difference of 16 bits";
  EXPECT_TRUE(code.set(HuffmanCode::Kind::kOthers, counts, symbols));
  EXPECT_EQ(code.find_long(~std::uint64_t{0}).bits, 0) << "111 is no code";
  EXPECT_EQ(code.find_short(~std::uint64_t{0}).bits, 0);
}

}  // namespace
}  // namespace touchline::testing
